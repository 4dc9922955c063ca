/* SPDX-License-Identifier: MIT */
/* A scene of two targets, each on a wire of its own. */
#pragma once

#include "tests/unit/aid/scene.h"

#define D1 "/28.551DDF030000"
#define D2 "/28.063BC8040000"
#define T1 D1 "/temperature12"
#define T2 D2 "/temperature12"
#define D3 "/29.B89115000000"
#define PIO D3 "/PIO.BYTE"
#define SENSED D3 "/sensed.BYTE"

void two_wires_begin(struct scene *s);
/* Start, and take both targets up. */
void two_wires_up(struct scene *s);
