/* SPDX-License-Identifier: MIT */
/* Checks of owsctl doctor: the services, owsd, and the programs beside it. */
#pragma once

struct doctor;

void check_services(struct doctor *d);
void check_owsd(struct doctor *d);
void check_faces(struct doctor *d);
