#include "choice.h"

#include "exit_status.h"
#include "failure.h"
#include "similar_name.h"

#include <stdio.h>
#include <string.h>

enum { CHOICES_MOST = 32 };

int choice_find(const char *option, const char *typed, choice_name *names, int *index) {
    const char *all[CHOICES_MOST];
    size_t count = 0, used = 0;
    char list[256] = "";
    for (; count < CHOICES_MOST && (all[count] = names((int)count)); count++) {
        if (strcmp(typed, all[count]) == 0) {
            *index = (int)count;
            return 0;
        }
        if (used < sizeof list)
            used += (size_t)snprintf(list + used, sizeof list - used, "%s%s", count ? ", " : "", all[count]);
    }
    const char *meant = similar_name(typed, all, count);
    return fail(STATUS_USAGE, "%s: '%s' is none of %s%s%s%s", option, typed, list, meant ? "; did you mean " : "",
                meant ? meant : "", meant ? "?" : "");
}
