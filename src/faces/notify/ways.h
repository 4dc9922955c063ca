/* SPDX-License-Identifier: MIT */
/*
 * The ways to people. Each goes through the queue by itself: what it has not told waits for it, and
 * what comes meanwhile is in the same message as soon as the way works again.
 *
 * Room src/faces/notify: the program owsd-notify: tells people of alarms.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "src/config/read/config.h"
#include "src/faces/kit/backoff.h"
#include "src/faces/kit/post.h"
#include "src/faces/kit/secret.h"
#include "src/faces/notify/queue.h"
#include "src/faces/notify/run.h"
#include "src/ground/text/log.h"

enum way_kind {
	WAY_MAIL,
	WAY_ESCALATE, /* mail to the second addresses */
	WAY_POST,
	WAY_COMMAND,
	WAYS,
};

struct way {
	uint64_t next;     /* the first entry that it has not told */
	bool busy;         /* a message is under way: */
	uint64_t end, out; /* the entry after it, and how many lost ones it counts */
	uint64_t gone;     /* entries of it that are not kept any more */
	uint64_t missed;   /* entries of its kind that went untold, and that it has to count */
	int64_t sent_ns, retry_ns;
	struct backoff backoff;
	struct run run;
	char *data;                  /* what is under way */
	char why[RUN_WORDS + 32];    /* why it does not work; "": it does */
	uint64_t told, failed, lost; /* messages that went, attempts that did not; entries */
};
struct ways {
	struct queue queue;
	struct way way[WAYS];
	struct post *post; /* NULL: there is none */
	/* Is the entry, whose words it may renew, to be told now? NULL: each is. */
	bool (*judge)(void *ctx, struct entry *entry);
	void *judge_ctx;
	bool held;       /* that cannot be said now: no message begins */
	struct log *log; /* NULL: none */
	const char *instance;
	char host[64], url[1400], token[SECRET_SIZE];
};

void ways_open(struct ways *ways, struct log *log, const char *instance,
               void (*watch)(void *ctx, int fd, short events), void *ctx);
/* Place for an entry. If there is none, one goes: the ways that would have told it count it. */
struct entry *ways_add(struct ways *ways);
/* Is there something to be told by that way in the file? */
bool ways_has(const struct config_notify *notify, enum way_kind kind);
/* Does it tell alarms that are escalated, or the others? */
bool ways_tells(enum way_kind kind, bool escalated);
/* Look at what is under way, and begin what is due. fd: ready for the POST; -1: none. */
void ways_step(struct ways *ways, const struct config_notify *notify, int fd, short ready,
               int64_t now_ns);
/* Try all at once again: the file is another. */
void ways_again(struct ways *ways);
/* When to look again. */
int64_t ways_next(const struct ways *ways, int64_t now_ns);
/* What is under way is given up. */
void ways_close(struct ways *ways);
/*
 * Tell a test message each way, print what became of it, and close. Waits as long as a way may
 * take. 0, or -EIO: not all of them have told it.
 */
int ways_test(struct ways *ways, const struct config_notify *given, const char *program,
              const char *instance);
