#include "core/status.h"

#include <stdarg.h>
#include <stdio.h>

const char *dif_status_text(dif_status status)
{
    switch (status) {
#define DIF_STATUS_CASE(name, number, text)                                                                            \
    case name:                                                                                                         \
        return text;
        DIF_STATUS_LIST(DIF_STATUS_CASE)
#undef DIF_STATUS_CASE
    }
    return "unknown status";
}

dif_status(dif_fail)(dif_error *err, dif_status status, const char *format, ...)
{
    if (err) {
        va_list args;
        va_start(args, format);
        err->status = status;
        vsnprintf(err->text, sizeof err->text, format, args);
        va_end(args);
    }
    return status;
}
