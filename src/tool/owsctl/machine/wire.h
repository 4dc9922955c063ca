/* SPDX-License-Identifier: MIT */
/* Checks of owsctl doctor: targets and signals. */
#pragma once

struct doctor;

void check_targets(struct doctor *d);
void check_wire(struct doctor *d);
