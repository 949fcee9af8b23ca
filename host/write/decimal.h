/* decimal.h - numbers as text, fast and in every locale the same */
#ifndef DECIMAL_H
#define DECIMAL_H

#include <stdint.h>

enum { DECIMAL_MOST = 16, DECIMAL_F64_MOST = 24 }; /* bytes of the longest number */

/* At most nine significant digits, as "%.9g": they read back as the same float. "nan", "inf" and "-inf" for what is no
 * number. Returns the address behind the text; no zero byte is appended. */
char *put_float_text(char *to, float value);

/* The fewest digits, 15 to 17, that read back as the same double. Slower: for meshes that need it. */
char *put_double_text(char *to, double value);

char *put_u32_text(char *to, uint32_t value);

#endif
