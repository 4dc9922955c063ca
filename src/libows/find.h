/* SPDX-License-Identifier: MIT */
/* The names that a program looks up: their ids, and the record of each id in the present image. */
#ifndef LIBOWS_FIND_H
#define LIBOWS_FIND_H

struct ows;
struct ows_id;

int find_resolve(struct ows *h, struct ows_id *id);
void find_free(struct ows *h);

#endif
