/* SPDX-License-Identifier: MIT */
/* The inside of the control room, which the files of this room share. */
#pragma once

#include <pthread.h>

#include "hal/base/time.h"
#include "hal/bus/bus.h"
#include "src/ground/service/listen.h"
#include "src/ground/text/log.h"
#include "src/memory/control/often.h"
#include "src/memory/control/rights.h"
#include "src/memory/shm/controller.h"
#include "src/memory/shm/peer.h"
#include "src/memory/shm/porter.h"
#include "src/public/ows.h"

/* Limits of a user, which do not hold for root. */
#define CONTROL_OF_USER 32
/* Seats that are kept for root and owsd's user, and of the rest for users that may command. */
#define CONTROL_KEPT 8
#define CONTROL_KEPT_FROM_READERS 64
/* A program has, beside its own, for two seconds those of the reloads before. */
#define CONTROL_HELD (4 * CONTROL_OF_USER)
/* Of all users; where held_full() no controller joins. */
#define CONTROL_HELD_ALL 1024
#define CONTROL_MEMORY (64u << 20)
/* In that time a program that connected has to send its hello. */
#define CONTROL_HELLO_NS (2 * NS_PER_S)
/* Programs that wait for a reload, and how long. */
#define CONTROL_ASKERS 4
#define CONTROL_ASK_NS (30 * NS_PER_S)

#define CONTROL_COUNTERS(X) \
	X(connections)      /* connections now */ \
	X(joined)           /* programs that connected */ \
	X(asked)            /* programs that asked for a reload, answered */ \
	X(refused_rights)   /* programs whose user may not */ \
	X(refused_limits)   /* programs refused: too many of a user, or of all */ \
	X(refused_protocol) /* programs that sent wrong words, or none in time */ \
	X(refused_errors)   /* no memory or descriptor; also while a connection waits */ \
	X(hung_up)          /* programs that ended their connection */ \
	X(died)             /* processes that ended while another process held their socket */

enum control_counter {
#define X(name) CONTROL_##name,
	CONTROL_COUNTERS(X)
#undef X
		CONTROL_COUNTER_COUNT
};

/* The engine's thread may touch a seat from JOINING to IN and from LEAVING to LEFT. */
enum control_state {
	CONTROL_FREE,
	CONTROL_HALF,   /* connected; its hello has not come */
	CONTROL_ASKING, /* it waits for a reload */
	CONTROL_ASKED,  /* that reload has begun */
	CONTROL_JOINING,
	CONTROL_TAKEN, /* the engine's thread takes it */
	CONTROL_IN,
	CONTROL_LEAVING,
	CONTROL_LEFT,   /* until the porter takes what it had */
	CONTROL_UNREAD, /* left, but for descriptors that lie unread in its socket */
};

/* What a program wants that connects; WELCOME_CONNECT: also while that is not known. */
enum welcome_deed { WELCOME_CONNECT, WELCOME_COMMAND, WELCOME_RELOAD };

/* What a controller gets of a generation. */
struct control_grant {
	struct controller_memory memory;
	size_t size;
	uint32_t *rights;
	uint32_t allowed; /* how many signals */
	int memfd;        /* until it is sent; -1 */
	int own;          /* owsd's own descriptor of it; -1 */
};

/* A memory that its controller has left, or that another has replaced at a reload. */
struct control_held {
	int own;
	uid_t uid;
	size_t size;
	int64_t until_ns; /* it is not emptied before */
	int64_t asked_ns; /* since when the porter has it to empty; 0: it has not */
	uint32_t slot;    /* of the porter */
};

struct control_seat {
	uint32_t state;           /* enum control_state */
	uint32_t news_state;      /* of news.c: may its thread use the socket news? */
	int fd, death;            /* the connection; the process's pidfd, -1 unknown */
	int bell, news, news_end; /* news: owsd's end; news_end: until it is sent */
	struct peer peer;
	struct ows_who who;
	uint8_t token[16];
	int64_t until_ns; /* of CONTROL_HALF, CONTROL_ASKING, CONTROL_ASKED */
	bool commands;    /* it wants to, by its hello */
	bool leaves;      /* seat_drop() was there */
	bool connected;   /* the porter has not been asked to hang up */
	enum welcome_deed deed;
	int refused;   /* with this errno it is; 0: it is not */
	bool sent;     /* descriptors went over the socket */
	bool welcomed; /* all was sent that there is to send */
	struct control_grant now, next;
};

static inline enum control_state control_state_of(const struct control_seat *p)
{
	return (enum control_state)__atomic_load_n(&p->state, __ATOMIC_ACQUIRE);
}

static inline void control_enter(struct control_seat *p, enum control_state state)
{
	__atomic_store_n(&p->state, state, __ATOMIC_RELEASE);
}

/* Does the seat belong to a controller that joins or has joined? */
static inline bool control_belongs(const struct control_seat *p)
{
	enum control_state state = control_state_of(p);

	return state == CONTROL_JOINING || state == CONTROL_TAKEN || state == CONTROL_IN;
}

/* The seats, and the sleepers of the image. */
#define NEWS_IMAGE OWS_CONTROLLERS
#define NEWS_PACES (OWS_CONTROLLERS + 1)
#define NEWS_WORDS ((NEWS_PACES + 31) / 32)

struct control {
	pthread_mutex_t lock; /* seats, but for what belongs to the engine's thread; config */
	const struct config *config;
	const struct controller_layout *layout;
	struct rights rights;
	int directory;
	char name[48]; /* of the socket in it */
	struct listen_file file;
	struct log *log;
	void (*ring)(void *ctx);
	void *ring_ctx;

	pthread_t thread;
	bool running;
	uint32_t stop;
	int epoll, listener, wake;
	struct porter *porter;
	int away[PORTER_FDS]; /* connections without a seat that are refused, all with away_err */
	unsigned away_count;
	int away_err;
	bool later; /* the porter had no time for something */
	int asked;  /* the bell of those that ask for a reload */
	bool accepts;
	int64_t now_ns;    /* when a thread took the lock; see control_lock() */
	int64_t accept_ns; /* not sooner */
	uint32_t serial;
	struct control_seat seats[OWS_CONTROLLERS];
	struct control_held held[CONTROL_HELD_ALL];
	unsigned held_count;
	struct often often;
	int64_t held_ns;  /* when to look next */
	uint32_t changes; /* counts seats that are for the engine's thread to look at */
	struct {
		uint32_t seen;
		unsigned at;
		unsigned end;          /* no memory stands at or after it */
		int64_t rest_until_ns; /* of news_wake() */
		struct controller_memory memories[OWS_CONTROLLERS]; /* of those that have joined */
	} engine;                                                   /* of the engine's thread */
	struct {
		pthread_t thread;
		bool running;
		uint32_t stop;
		int bell;
		uint32_t due[NEWS_WORDS]; /* a bit for each seat and for the image */
		const uint32_t *word;     /* of the image, on which programs sleep */
		/* of the thread */
		uint32_t taken[NEWS_WORDS]; /* what was due and is not rung yet */
		unsigned slow;
		struct news_pace {
			int64_t rest_until_ns; /* 0: it is not slow */
		} paces[NEWS_PACES];
	} news;
	struct log_rate refused, full;
	struct bus_counter counters[CONTROL_COUNTER_COUNT];
};

static inline void control_tally(struct control *c, enum control_counter what)
{
	bus_count(&c->counters[what], 1);
}

/* Each thread that takes the lock has the time of that moment in now_ns, not another's last. */
static inline void control_lock(struct control *c)
{
	pthread_mutex_lock(&c->lock);
	c->now_ns = ows_now();
}
