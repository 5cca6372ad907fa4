#include "core/io/md5.h"

#include <string.h>

dif_md5 dif_md5_begin(void)
{
    const dif_md5 sum = {.state = {0x67452301u, 0xefcdab89u, 0x98badcfeu, 0x10325476u}};
    return sum;
}

static uint32_t rotate(uint32_t x, int n)
{
    return x << n | x >> (32 - n);
}

/* floor(2^32 |sin i|), i = 1 ... 64 */
static const uint32_t SINES[64] = {
    0xd76aa478u, 0xe8c7b756u, 0x242070dbu, 0xc1bdceeeu, 0xf57c0fafu, 0x4787c62au, 0xa8304613u, 0xfd469501u,
    0x698098d8u, 0x8b44f7afu, 0xffff5bb1u, 0x895cd7beu, 0x6b901122u, 0xfd987193u, 0xa679438eu, 0x49b40821u,
    0xf61e2562u, 0xc040b340u, 0x265e5a51u, 0xe9b6c7aau, 0xd62f105du, 0x02441453u, 0xd8a1e681u, 0xe7d3fbc8u,
    0x21e1cde6u, 0xc33707d6u, 0xf4d50d87u, 0x455a14edu, 0xa9e3e905u, 0xfcefa3f8u, 0x676f02d9u, 0x8d2a4c8au,
    0xfffa3942u, 0x8771f681u, 0x6d9d6122u, 0xfde5380cu, 0xa4beea44u, 0x4bdecfa9u, 0xf6bb4b60u, 0xbebfbc70u,
    0x289b7ec6u, 0xeaa127fau, 0xd4ef3085u, 0x04881d05u, 0xd9d4d039u, 0xe6db99e5u, 0x1fa27cf8u, 0xc4ac5665u,
    0xf4292244u, 0x432aff97u, 0xab9423a7u, 0xfc93a039u, 0x655b59c3u, 0x8f0ccc92u, 0xffeff47du, 0x85845dd1u,
    0x6fa87e4fu, 0xfe2ce6e0u, 0xa3014314u, 0x4e0811a1u, 0xf7537e82u, 0xbd3af235u, 0x2ad7d2bbu, 0xeb86d391u};

static void take_block(uint32_t state[4], const unsigned char *block)
{
    static const unsigned char SHIFTS[4][4] = {{7, 12, 17, 22}, {5, 9, 14, 20}, {4, 11, 16, 23}, {6, 10, 15, 21}};
    uint32_t a = state[0], b = state[1], c = state[2], d = state[3];
    for (uint32_t i = 0; i < 64; i++) {
        const uint32_t round = i / 16;
        const uint32_t mixed = round == 0   ? (b & c) | (~b & d)
                               : round == 1 ? (d & b) | (~d & c)
                               : round == 2 ? b ^ c ^ d
                                            : c ^ (b | ~d);
        const uint32_t index = (round == 0 ? i : round == 1 ? 5 * i + 1 : round == 2 ? 3 * i + 5 : 7 * i) % 16;
        const unsigned char *byte = block + 4 * index;
        const uint32_t word =
            (uint32_t)byte[0] | (uint32_t)byte[1] << 8 | (uint32_t)byte[2] << 16 | (uint32_t)byte[3] << 24;
        const uint32_t sum = a + mixed + SINES[i] + word;
        a = d;
        d = c;
        c = b;
        b += rotate(sum, SHIFTS[round][i % 4]);
    }
    state[0] += a;
    state[1] += b;
    state[2] += c;
    state[3] += d;
}

void dif_md5_add(dif_md5 *sum, const void *data, size_t n)
{
    const unsigned char *byte = data;
    while (n > 0) {
        const size_t n_used = (size_t)(sum->n % 64), n_free = 64 - n_used, n_take = n < n_free ? n : n_free;
        memcpy(sum->block + n_used, byte, n_take);
        sum->n += n_take;
        byte += n_take;
        n -= n_take;
        if (n_take == n_free)
            take_block(sum->state, sum->block);
    }
}

void dif_md5_hex(const dif_md5 *sum, char hex[33])
{
    static const unsigned char ENDING[64] = {0x80};
    dif_md5 end = *sum;
    unsigned char length[8];
    for (int i = 0; i < 8; i++)
        length[i] = (unsigned char)(8 * sum->n >> 8 * i);
    dif_md5_add(&end, ENDING, 1 + (size_t)((119 - sum->n % 64) % 64));
    dif_md5_add(&end, length, sizeof length);
    for (int i = 0; i < 16; i++) {
        const unsigned byte = end.state[i / 4] >> 8 * (i % 4) & 255u;
        hex[2 * i] = "0123456789abcdef"[byte >> 4];
        hex[2 * i + 1] = "0123456789abcdef"[byte & 15u];
    }
    hex[32] = '\0';
}
