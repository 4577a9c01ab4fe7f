/* tree.c - the core without Python: grows the tree of the sharper method, three parameters or one,
   and prints it, so that machines can be compared (make arm).

       tree a b c half-a half-b half-c together */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "search/search.h"

int main(int argc, char **argv)
{
    cv_wave waves[3] = { { .k = { 1, 0 } }, { .k = { 0, 1 } }, { .k = { 1, 1 } } };
    const int together = argc > 7 && atoi(argv[7]);
    const cv_problem problem = { .n_angles = 2,
                                 .n_waves = 3,
                                 .n_parameters = together ? 1 : 3,
                                 .waves = waves,
                                 .angle = { "0", "0" },
                                 .half = { "1", "1" },
                                 .frame = { { 1, 0 }, { 0, 1 } },
                                 .odd = 1,
                                 .symmetric = argc > 7 && !strcmp(argv[1], argv[2]) &&
                                              !strcmp(argv[4], argv[5]) };
    cv_search *s;
    cv_view view;

    if (argc != 8)
        return 2;
    for (int k = 0; k < 3; k++) {
        waves[k].phase = "0";
        waves[k].amplitude = argv[1 + k];
        for (int m = 0; m < problem.n_parameters; m++)
            waves[k].part[m] = together || m == k ? argv[4 + k] : "0";
    }
    if (cv_search_new(&s, &problem, NULL, CV_LOEWNER, 35, 120, 0, 0, 0) != CV_OK ||
        cv_begin(s, 1L << 30, 1e300) != CV_OK || cv_set_up(s) != CV_OK || cv_work(s) != CV_OK)
        return 1;
    fprintf(stderr, "%d prisms at a time\n", s->method->lanes(s->work));
    if (cv_look(s, 1, &view) != CV_OK)
        return 1;
    fwrite(view.tree, 1, view.length, stdout);
    cv_forget_view(&view);
    cv_search_free(s);
    return 0;
}
