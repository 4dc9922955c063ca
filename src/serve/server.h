/* SPDX-License-Identifier: MIT */
/* The inside of the server, shared by the files of this folder. */
#ifndef SERVE_SERVER_H
#define SERVE_SERVER_H

#include <pthread.h>

#include "hal/bus/time.h"
#include "src/serve/code.h"
#include "src/serve/directory.h"
#include "src/serve/guests.h"
#include "src/serve/kept.h"
#include "src/serve/request.h"
#include "src/serve/signals.h"
#include "src/serve/via.h"
#include "src/text/log.h"

#define SERVER_CLIENTS 512
#define SERVER_DIRECTORIES 4
#define SERVER_LISTENERS (LISTEN_MAX + 1)

/* Time limits, as the genuine owserver has them. */
#define REQUEST_NS (10 * NS_PER_S) /* from the first byte, or the connection, to the end */
#define IDLE_NS (600 * NS_PER_S)   /* of a connection that asked to be kept */
#define EVICT_NS (10 * NS_PER_S)   /* idle for so long, it goes when another waits */
#define KEEPALIVE_NS NS_PER_S
#define SEND_NS (10 * NS_PER_S)   /* that no byte of an answer is taken */
#define ANSWER_NS (60 * NS_PER_S) /* for the whole of an answer */
#define APPLY_NS (10 * NS_PER_S)  /* until a commanded output is confirmed */
#define APPLY_LOOK_NS (10 * NS_PER_MS)

/*
 * What a connection's bytes are put in: the request, and behind it what is sent. Pages of it that
 * are not touched cost nothing.
 */
#define AREA_ANSWER 2048 /* where the answer begins, at least */
#define AREA_SIZE (72 * 1024)

enum client_state {
	CLIENT_FREE,
	CLIENT_READING,  /* waits for a request, or for the rest of one */
	CLIENT_WORKING,  /* the engine has its request */
	CLIENT_QUEUED,   /* waits for a directory to be free */
	CLIENT_APPLYING, /* waits for its command to reach the bus */
	CLIENT_SENDING,
	CLIENT_LEFT, /* gone, but the engine or a bus still has what is its */
};

/* What the engine was asked for, and so what comes next. */
enum client_step {
	STEP_READ,
	STEP_WRITE,
	STEP_WRITE_EACH, /* to one target after another */
	STEP_DIR,
	STEP_BUSES, /* a look at the root, to learn what bus.N is */
	STEP_PROBE,
	STEP_REFUSE,    /* a directory cannot be read or written: is it there at all? */
	STEP_ADDRESS,   /* of an alias */
	STEP_FAMILY,    /* of an alias */
	STEP_STRUCTURE, /* the type of a property that is not known here */
};

struct client {
	int fd;
	uint8_t state, step;
	bool readable, ended; /* as far as the kernel has said; no more bytes come */
	bool queued;          /* in the round */
	bool network;         /* not a unix socket */
	bool is_get, lent, once_more;
	uint8_t alive_left; /* bytes of a keep-alive that was begun */
	unsigned target;    /* of several that are asked in turn */
	int32_t worst;      /* of those asked so far; 1: none answered yet */
	int64_t since_ns;   /* of the state; READING: of the first byte */
	int64_t tick_ns;    /* of the last progress, or the last keep-alive */
	int64_t active_ns; /* of its beginning, or of the end of a request that was more than a NOP */
	uint64_t served;   /* requests */

	size_t have, need,
		length; /* bytes in area; of the request in it: as far as known, its end */
	size_t past;    /* of the bytes in area: of an answered request that a bus still has */
	struct request request;
	struct node node;
	char path[NODE_PATH_MAX + 16]; /* as the engine was given it */
	struct engine_guest guest;
	struct via via;
	uint32_t value_len; /* READ: of what is in the room for the answer */
	struct signals_command command;
	struct directory *directory;
	const uint8_t *out; /* what is sent */
	uint32_t out_len, out_at;
	uint8_t *area;
};

#define SERVE_COUNTERS(X) \
	X(connections) /* accepted */ \
	X(clients)     /* now */ \
	X(requests) \
	X(errors)       /* answered with an error */ \
	X(kept_answers) /* reads that needed no bus */ \
	X(bus_requests) /* handed to the engine */ \
	X(keepalives) \
	X(full)           /* times that a new one had to wait for a place */ \
	X(not_kept)       /* closed behind an answer, because others waited */ \
	X(refused_peers)  /* not in ListenAllow */ \
	X(refused_writes) /* in read-only mode */ \
	X(came_round)     /* had been here before, by way of other servers */ \
	X(evicted)        /* idle for long, closed because others waited */ \
	X(refused_errors) /* closed at once, because the kernel lacked something */ \
	X(garbage)        /* no requests */ \
	X(timeouts)       /* half requests, answers nobody took, idle connections */ \
	X(bytes_in) \
	X(bytes_out)

enum serve_counter {
#define X(name) COUNT_##name,
	SERVE_COUNTERS(X)
#undef X
		SERVE_COUNTER_COUNT,
};

struct serve {
	const struct config *config;
	const struct image *image;
	const char *instance;
	struct log *log;
	struct guests guests;
	struct kept *kept, *prepared; /* for the next reload */
	struct serve_next {           /* of a reload, for the thread to take */
		const struct config *config;
		const struct image *image;
		struct kept *kept;
		const int *ports;
	} * next;
	struct signals *signals;
	struct buses buses;
	uint8_t token[BUS_TOKEN];
	bool passes_on; /* a target is a server, which may lead back here */

	struct {
		int fd;
		bool network;
	} listeners[SERVER_LISTENERS];
	unsigned listener_count, listener_at; /* at: accepts first */
	bool accepting;                       /* more connections may wait */
	/* Accepted when all places were taken: while one is held, no more are accepted. */
	struct {
		bool is;
		int fd;
		bool network;
	} held;
	int epoll_fd;

	pthread_t thread;
	bool running;
	uint32_t stop;
	int64_t now_ns;
	int64_t look_ns; /* no time limit of a client ends before */

	uint8_t *areas;
	struct directory *directories;
	struct client *clients;
	uint16_t *free;
	unsigned free_count, used; /* used: the highest ever in use + 1 */
	uint16_t *round;           /* clients that have something to do, in turn */
	unsigned round_at, round_count;
	unsigned queued; /* clients that wait for a directory */
	struct log_rate full_rate, error_rate, peer_rate;
	struct bus_counter counters[SERVE_COUNTER_COUNT];
};

static inline void count(struct serve *s, enum serve_counter what, uint64_t by)
{
	bus_count(&s->counters[what], by);
}

#endif
