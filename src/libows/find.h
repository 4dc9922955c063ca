/* SPDX-License-Identifier: MIT */
/* Names that a program asks for, and what of the image they mean. */
#ifndef LIBOWS_FIND_H
#define LIBOWS_FIND_H

struct ows;
struct ows_id;

int find_resolve(struct ows *h, struct ows_id *id);
void find_free(struct ows *h);

#endif
