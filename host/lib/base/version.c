#include "tetracubes.h"

#define TEXT2(x) #x
#define TEXT(x)  TEXT2(x)

const char *tc_version(void) { return TEXT(TC_VERSION_MAJOR) "." TEXT(TC_VERSION_MINOR) "." TEXT(TC_VERSION_PATCH); }
