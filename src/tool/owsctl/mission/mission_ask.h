/* SPDX-License-Identifier: MIT */
/* A logger as a target shows it: what its mission is, and requests for its properties. */
#pragma once

#include "src/tool/owsctl/open.h"

struct mission {
	struct target target;
	const char *device; /* its path, as given */
	bool minutes;       /* a DS1921: intervals are whole minutes, one quantity */
};

/* Open the target and look what the device is. CTL_DONE, or the status after printing why. */
int mission_open(const struct ctl *ctl, const char *device, int64_t timeout_ns,
                 struct mission *mission);

/* A property as a number, read past all caches; -errno. */
int mission_read(struct mission *mission, const char *property, double *value);
/* The same: CTL_DONE, or CTL_FAILED after printing why. */
int mission_need(struct mission *mission, const char *property, double *value);
/* Write a number. CTL_DONE, or CTL_FAILED after printing why. */
int mission_write(struct mission *mission, const char *property, double value);
/* Print that reading failed; returns CTL_FAILED. */
int mission_failed(const struct mission *mission, const char *property, int err);
/* Seconds between two samples; -errno. */
int mission_interval(struct mission *mission, double *seconds);

/* UTC, as 2026-11-22T10:00:00Z. */
#define MISSION_TIME 32
void mission_time(double seconds, char text[MISSION_TIME]);
