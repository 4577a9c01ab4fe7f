/* console.h - what the files of the tests' console share: routines of the core by name, one at a
   time, from exact numbers to exact numbers. */
#ifndef CONSOLE_H
#define CONSOLE_H

#include "arith/apm.h"
#include "thesis/unit.h"

/* What is asked for: a routine by its name, nin numbers and room for nout. */
typedef struct {
    const char *name;
    int dp, as_printed, nin, nout;
    apm_t *in, *out;
} question;

/* The name of a routine, how many numbers it takes and how many it gives. */
typedef struct {
    const char *name;
    int nin, nout;
} shape;

/* Does the question ask for the first shape of table[0], table[1], ..., of so many bytes each? */
int asks_for(const question *q, const shape *shape);

/* Each answers the questions that it knows: CV_OK, an error, or NOT_MINE. */
enum { NOT_MINE = 1000 };
int numbers_answer(const question *q);                  /* numbers.c */
int loewner_answer(const question *q);                  /* loewner.c */
int Rthesis_answer(Runit *u, const question *q);        /* thesis.h, in exact decimals, */
int thesis_answer(unit *u, const question *q);          /* and in doubles */

#endif
