/* SPDX-License-Identifier: MIT */
/*
 * The control socket of an instance without owsd: a thread that welcomes whoever connects, with a
 * memory that the test reads by the engine's functions. It can lie, as owsd never does.
 */
#pragma once

#include <pthread.h>

#include "src/memory/shm/controller.h"
#include "src/memory/shm/dir.h"

#define DOOR_CONTROLLERS 40

enum door_lie {
	DOOR_HONEST,
	DOOR_SILENT,   /* it reads the hello and sends nothing */
	DOOR_HANGS_UP, /* it closes the connection instead of a welcome */
	DOOR_REFUSES,  /* -EACCES */
	DOOR_OTHER_MAGIC,
	DOOR_OTHER_MAJOR,
	DOOR_SHORT,  /* half a welcome */
	DOOR_NO_FDS, /* a welcome without descriptors */
	DOOR_ONE_FD, /* with the memory alone */
	DOOR_MANY_FDS,
	DOOR_NO_SEALS,
	DOOR_OTHER_SIZE,   /* it promises more than the memory has */
	DOOR_SMALL,        /* the memory is smaller than its header */
	DOOR_OTHER_MEMORY, /* the header is none */
	DOOR_OTHER_START,  /* of another generation than the image */
	DOOR_OUTSIDE,      /* its slots lie outside */
	DOOR_LOSES,        /* it sends no welcome after a reload */
	DOOR_LIES          /* how many there are */
};

struct door_controller {
	int connection, memory_fd, bell, news;
	bool gone; /* hung up */
	struct ows_hello hello;
	struct controller_memory memory;
};

/* The thread and the test share it: lie, controllers and count are looked at with the lock held. */
struct door {
	struct shm_dir dir;
	char file[64];
	int listener, wake;
	bool stop;
	enum door_lie lie;
	pthread_t thread;
	pthread_mutex_t lock;
	struct controller_layout layout;
	struct door_controller controllers[DOOR_CONTROLLERS];
	unsigned count; /* of all that were ever welcomed */
};

/* Listen as NAME.control in this user's directory, with memories for signals of these types. */
void door_open(struct door *door, const char *instance, uint32_t generation, uint32_t start_id,
               const uint8_t *types, uint32_t count, uint16_t text_cap);
/* Hang up on all, and listen no more: as an owsd that is killed. */
void door_close(struct door *door);
/* Memories of another generation for all that are connected, with what they had, and welcomes. */
void door_reload(struct door *door, uint32_t generation, uint32_t start_id, const uint8_t *types,
                 uint32_t count, uint16_t text_cap, const uint32_t *rows);
/* Lie to whoever connects from now on. */
void door_lie(struct door *door, enum door_lie lie);
/* Controller i of those who were ever welcomed. */
struct door_controller *door_controller(struct door *door, unsigned i);
unsigned door_count(struct door *door);
/* Wait until the controller has hung up. */
void door_wait_gone(struct door *door, unsigned i);
/* How often the controller rang since the last call. */
uint64_t door_rings(struct door *door, unsigned i);
