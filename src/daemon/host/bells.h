/* SPDX-License-Identifier: MIT */
/*
 * What the engine's thread sleeps on: one bell for the threads of owsd and one for each controller.
 * A controller's bell that rings too often is left out for a while; what the controller has marked
 * is looked at whenever the engine is awake.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "src/public/ows_layout.h"

/* A controller's bell may ring so often in that time; less often when all together ring a lot. */
#define BELLS_NS (100 * INT64_C(1000000))
#define BELLS_MAX 256
#define BELLS_ALL 1024
#define BELLS_SHARE 16

struct bells {
	int epoll, own;
	uint32_t awake;   /* the thread looks before it sleeps: no need to wake it */
	uint32_t rung;    /* there is something new from a thread of owsd */
	int64_t since_ns; /* when the counts began */
	unsigned all, muted;
	struct {
		int fd; /* -1: none */
		unsigned rings;
		bool muted;
	} controllers[OWS_CONTROLLERS];
	uint64_t mutes; /* how often a bell was left out */
};

/* 0 or a negative errno. */
int bells_open(struct bells *bells);
void bells_close(struct bells *bells);
/* Any thread: wake the engine's. */
void bells_ring(struct bells *bells);

/* The others are for the engine's thread. fd: an eventfd that is never read. */
void bells_add(struct bells *bells, unsigned seat, int fd);
void bells_remove(struct bells *bells, unsigned seat);
/* The engine looks at everything now: what rang before counts no more. */
void bells_look(struct bells *bells);
/*
 * Going to sleep: a ring after this wakes bells_sleep(). Returns whether there was one since
 * bells_look(). The caller looks at what controllers have marked between this and bells_sleep().
 */
bool bells_close_eyes(struct bells *bells);
/* Sleep until then or the next ring. */
void bells_sleep(struct bells *bells, int64_t until_ns);
void bells_open_eyes(struct bells *bells);
