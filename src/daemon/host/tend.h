/* SPDX-License-Identifier: MIT */
/* The supervisor's upkeep: looks for the image, and finishes what a reload has left to do. */
#pragma once

struct host;

/*
 * The work that must not be done on the engine's thread: look whether the image is still there, and
 * finish what a reload could not do. The supervisor calls it at least twice a second.
 */
void host_tend(struct host *host);

/*
 * Try again what a reload could not finish after the engine had taken it; log and count it
 * until it is done. host_tend() calls it once a second.
 */
void host_finish_reload(struct host *host);
