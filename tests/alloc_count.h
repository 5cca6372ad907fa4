/* A heap that counts its blocks and can fail: link tests/alloc_count.c into a test, and it replaces core/alloc.c. */
#ifndef DIF_TEST_ALLOC_COUNT_H
#define DIF_TEST_ALLOC_COUNT_H

/* The k-th call from now (1, 2, ...) and every later one fails; 0 = none does. */
void test_alloc_fail_from(int k);

/* Calls since the last test_alloc_fail_from, and blocks that nobody gave back. */
int test_alloc_calls(void);
int test_alloc_live(void);

#endif
