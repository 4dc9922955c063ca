/* SPDX-License-Identifier: MIT */
/* Checks of owsctl doctor: the machine. */
#pragma once

struct doctor;

void check_disk(struct doctor *d);
void check_configuration(struct doctor *d);
void check_board(struct doctor *d);
void check_rights(struct doctor *d);
void check_signals(struct doctor *d);
void check_clock(struct doctor *d);
