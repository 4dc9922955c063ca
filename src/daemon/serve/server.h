/* SPDX-License-Identifier: MIT */
/* The inside of the server, shared by the files of this folder. */
#pragma once

#include <netinet/in.h>
#include <pthread.h>

#include "hal/base/time.h"
#include "src/daemon/serve/code.h"
#include "src/daemon/serve/directory.h"
#include "src/daemon/serve/guests.h"
#include "src/daemon/serve/kept.h"
#include "src/daemon/serve/request.h"
#include "src/daemon/serve/signals.h"
#include "src/ground/service/budget.h"
#include "src/ground/service/listen.h"
#include "src/ground/text/log.h"
#include "src/public/ows_layout.h"

#define SERVER_CLIENTS 512
#define SERVER_DIRECTORIES 4
#define SERVER_LISTENERS (LISTEN_MAX + 2)

/* Time limits, as the genuine owserver has them. */
#define REQUEST_NS (10 * NS_PER_S) /* from the first byte, or the connection, to the end */
#define IDLE_NS (600 * NS_PER_S)   /* of a connection that asked to be kept */
#define EVICT_NS (10 * NS_PER_S)   /* an idle client is closed when another one waits */
#define KEEPALIVE_NS NS_PER_S
#define SEND_NS (10 * NS_PER_S)   /* while the client takes no byte of an answer */
#define ANSWER_NS (60 * NS_PER_S) /* until the client has taken the whole answer */
#define APPLY_NS (10 * NS_PER_S)  /* until the bus has a commanded output */
#define APPLY_LOOK_NS (10 * NS_PER_MS)
/* Where clients may write the server sleeps no longer, so as to see when it did not run. */
#define LOOK_MS 500

/*
 * The area of a connection: the request, and after it the answer. Pages that are not touched cost
 * no memory.
 */
#define AREA_ANSWER 2048 /* the lowest offset at which an answer begins */
#define AREA_SIZE (72 * 1024)

enum client_state {
	CLIENT_FREE,
	CLIENT_READING,  /* waits for a request, or for the rest of one */
	CLIENT_WORKING,  /* the engine has its request */
	CLIENT_QUEUED,   /* waits for a directory to be free */
	CLIENT_APPLYING, /* waits for its command to reach the bus */
	CLIENT_SENDING,
	CLIENT_LEFT, /* the client has left, but the engine or a bus still uses its memory */
};

/* The question that the engine has; its answer decides what comes next. */
enum client_step {
	STEP_READ,
	STEP_WRITE,
	STEP_WRITE_EACH, /* to one target after another */
	STEP_DIR,
	STEP_BUSES, /* the list of the root, to learn which bus is bus.N */
	STEP_PROBE,
	STEP_REFUSE,    /* is there a directory at all, of those that cannot be read or written? */
	STEP_ADDRESS,   /* the address of an alias */
	STEP_WHOSE,     /* the same, of an alias that is written to */
	STEP_ALIAS,     /* the same, of an alias of the table */
	STEP_FAMILY,    /* the family of an alias */
	STEP_STRUCTURE, /* the type of a property that the server does not know */
};

struct client {
	int fd;
	uint8_t state, step;
	bool readable, ended; /* as epoll has reported; ended: no more bytes come */
	bool queued;          /* the client is in the round */
	bool network;         /* the socket is no unix socket */
	bool own;             /* the socket is NAME.sock, which takes no writes */
	bool watched;         /* epoll reports on the socket */
	bool is_get, lent, once_more;
	bool waits;               /* APPLYING: owsd has still to look at the commands of others */
	struct sockaddr_in6 peer; /* the client's address, maybe a sockaddr_in, if network */
	uint8_t alive_left;       /* bytes left of a keep-alive that was begun */
	unsigned target;          /* the one that answers now, of those that are asked in turn */
	int32_t worst;            /* the result of the targets so far; 1: none has answered yet */
	int64_t since_ns;         /* when the state began; READING: when the first byte came */
	int64_t tick_ns;          /* the time of the last progress, or of the last keep-alive */
	int64_t came_ns;          /* the bytes that are not yet read came later than that */
	int64_t given_ns;         /* those that were read last did */
	int64_t active_ns; /* when the connection began, or the last request other than NOP ended */
	uint64_t served;   /* requests that were answered */
	struct budget budget;

	size_t have, need, length; /* bytes in the area, and the request's length as far as known */
	size_t past;               /* bytes of an answered request that a bus still uses */
	struct request request;
	struct node node;
	uint8_t whose[ROM_LEN];        /* WRITE: the device, also where the node has its alias */
	int output;                    /* WRITE: the record whose alias is asked for */
	char path[NODE_PATH_MAX + 16]; /* the path that the engine gets */
	struct engine_guest guest;
	struct tokens passed; /* go with the request to a target */
	uint32_t value_len;   /* READ: bytes of value in client_room() */
	struct signals_command command;
	struct directory *directory;
	const uint8_t *out; /* the answer's bytes */
	uint32_t out_len, out_at;
	uint8_t *area;
};

#define SERVE_COUNTERS(X) \
	X(connections)    /* connections accepted */ \
	X(clients)        /* clients connected now */ \
	X(requests)       /* requests of clients */ \
	X(errors)         /* requests answered with an error */ \
	X(kept_answers)   /* reads that needed no bus */ \
	X(bus_requests)   /* requests to the engine */ \
	X(keepalives)     /* keep-alives for clients that wait */ \
	X(full)           /* connections that had to wait for a place */ \
	X(not_kept)       /* connections closed after an answer, because others waited */ \
	X(refused_peers)  /* peers that are not in ListenAllow */ \
	X(refused_writes) /* writes refused: read-only, ControlAllow, too old, beside an output */ \
	X(came_round)     /* requests that came back by way of other servers */ \
	X(evicted)        /* idle clients closed because others waited */ \
	X(refused_errors) /* connections closed at once: the kernel lacked something */ \
	X(costly)         /* clients closed, because each byte to them took long */ \
	X(garbage)        /* frames that are no requests */ \
	X(timeouts)       /* half requests, answers no client took, idle connections */ \
	X(bytes_in)       /* bytes of clients */ \
	X(bytes_out)      /* bytes to clients */ \
	X(absent)         /* addresses of Listen that cannot be reached now */

enum serve_counter {
#define X(name) COUNT_##name,
	SERVE_COUNTERS(X)
#undef X
		SERVE_COUNTER_COUNT,
};

struct serve {
	const struct config *config;
	const struct image *image;
	const char *instance, *dir;
	int directory; /* the same, open */
	struct log *log;
	struct porter *porter;
	/* Unix sockets that end, until the porter takes them; owsd accepts none with too many. */
	int away[2 * SERVER_CLIENTS];
	unsigned away_count;
	struct guests guests;
	struct kept *kept, *prepared; /* prepared: for the next reload */
	struct serve_next {           /* what a reload hands to the thread */
		const struct config *config;
		const struct image *image;
		struct kept *kept;
		const int *ports;
	} * next;
	struct signals *signals;
	struct buses buses;
	uint8_t token[BUS_TOKEN];
	bool passes_on; /* a target is an owserver, which may ask this server in turn */

	struct listener {
		int fd;                   /* -1: a network's that is not open yet */
		bool network, own;        /* own: NAME.sock in the directory of owsd's files */
		struct listen_address at; /* of network */
		struct listen_file file;  /* of the others */
		int64_t came_ns;          /* who waits there came later than that */
	} listeners[SERVER_LISTENERS];
	unsigned listener_count, listener_at; /* listener_at: the one that accepts first */
	uint32_t waiting; /* listeners that may have connections, one bit each */
	bool accepting;   /* and the server may accept them now */
	/* Accepted when all places were taken. While it is held, no more are accepted. */
	struct {
		bool is;
		int fd;
		struct listener from;
		struct sockaddr_in6 peer;
	} held;
	int unserved[SERVER_LISTENERS]; /* what listeners_look() said of each; of serve_absent() */
	int epoll_fd;

	pthread_t thread;
	bool running;
	uint32_t stop;
	int64_t now_ns;
	int64_t came_ns, asked_ns; /* what epoll reports now came later; will report next */
	int64_t look_ns;           /* the earliest time limit of all clients */

	uint8_t *areas;
	struct directory *directories;
	struct client *clients;
	uint16_t *free;
	unsigned free_count, used; /* used: the highest ever in use + 1 */
	uint16_t *round;           /* clients that have something to do, in their order */
	unsigned round_at, round_count;
	unsigned again;  /* how often a client was asked in place of epoll, since that was */
	int64_t rest_ns; /* of thread_yield() */
	unsigned queued; /* clients that wait for a directory */
	struct log_rate full_rate, error_rate, peer_rate, costly_rate;
	struct bus_counter counters[SERVE_COUNTER_COUNT];
};

/* A place or a descriptor is free. */
static inline void accept_again(struct serve *s)
{
	s->accepting |= s->held.is || s->waiting;
}

static inline void count(struct serve *s, enum serve_counter what, uint64_t by)
{
	bus_count(&s->counters[what], by);
}
