/* Is a page well formed? For the tests of reports/. */
#ifndef DIF_TEST_WELL_FORMED_H
#define DIF_TEST_WELL_FORMED_H

#include "near.h"

#include <ctype.h>
#include <string.h>

static inline bool is_void(const char *name)
{
    static const char *const names[] = {"meta", "br"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (strcmp(name, names[i]) == 0)
            return true;
    }
    return false;
}

/* Reads a tag's name at *at (behind '<' or '</'); moves behind its '>'; true if the tag closes itself. */
static inline bool read_tag(const char **at, char name[32])
{
    size_t n = 0;
    while (isalnum((unsigned char)**at) && n < 31)
        name[n++] = *(*at)++;
    name[n] = '\0';
    char quote = '\0';
    for (; **at && (quote || **at != '>'); (*at)++) {
        if (quote)
            quote = **at == quote ? '\0' : quote;
        else if (**at == '"' || **at == '\'')
            quote = **at;
        else if (**at == '<')
            fail_msg("'<' inside a tag: %.60s", *at);
    }
    if (**at != '>')
        fail_msg("a tag does not end");
    (*at)++;
    return (*at)[-2] == '/';
}

/* Every element is closed in order, every '&' begins a character reference. */
static inline void assert_well_formed(const char *page)
{
    char stack[64][32], name[32];
    int depth = 0;
    assert_int_equal(strncmp(page, "<!DOCTYPE html>\n", 16), 0);
    for (const char *at = page + 16; *at;) {
        if (*at == '&') {
            const size_t n = strspn(at + 1, "#abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789");
            if (n == 0 || at[1 + n] != ';')
                fail_msg("a bare '&': %.40s", at);
            at += n + 2;
        } else if (*at != '<') {
            at++;
        } else if (at[1] == '/') {
            at += 2;
            read_tag(&at, name);
            if (depth == 0 || strcmp(stack[depth - 1], name) != 0)
                fail_msg("</%s> closes <%s>", name, depth ? stack[depth - 1] : "nothing");
            depth--;
        } else {
            at++;
            const bool closed = read_tag(&at, name);
            if (!*name)
                fail_msg("a bare '<': %.40s", at);
            if (!closed && !is_void(name)) {
                assert_in_range(depth, 0, 63);
                memcpy(stack[depth++], name, sizeof name);
            }
        }
    }
    assert_int_equal(depth, 0);
}

#endif
