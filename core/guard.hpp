// The one door through which C++ shims fail: no exception crosses into C.
#ifndef DIF_GUARD_HPP
#define DIF_GUARD_HPP

#include <exception>
#include <new>

#include "core/status.h"

template <class F> dif_status dif_guard(dif_error *err, F &&body) noexcept
{
    try {
        return body();
    } catch (const std::bad_alloc &) {
        return dif_fail(err, DIF_ERR_NOMEM, "out of memory in a C++ library");
    } catch (const std::exception &e) {
        return dif_fail(err, DIF_ERR_FOREIGN, "%s", e.what());
    } catch (...) {
        return dif_fail(err, DIF_ERR_FOREIGN, "a library threw something that is not a std::exception");
    }
}

#endif
