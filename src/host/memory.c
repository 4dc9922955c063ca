/* SPDX-License-Identifier: MIT */
/*
 * The segments of a running owsd: made, shown, renewed when a program destroys them, and retired.
 */
#include <errno.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "hal/bus/time.h"
#include "src/engine/table.h"
#include "src/host/memory.h"
#include "src/libows/ows.h"
#include "src/shm/carry.h"
#include "src/shm/futex.h"
#include "src/shm/hint.h"
#include "src/shm/owner.h"

#define COMMANDS (sizeof(((struct memory *)0)->commands) / sizeof(struct memory_commands))

static int64_t wall_ns(void)
{
	struct timespec t;

	clock_gettime(CLOCK_REALTIME, &t);
	return (int64_t)t.tv_sec * NS_PER_S + t.tv_nsec;
}

static uint32_t random_id(void)
{
	uint32_t id = 0;

	if (getrandom(&id, sizeof(id), GRND_NONBLOCK) != (ssize_t)sizeof(id))
		id = (uint32_t)wall_ns() ^ (uint32_t)getpid();
	return id | 1;
}

/* Open the image that the previous owsd left, if this owsd may mark it retired. */
static bool open_image_before(const char *instance, struct segment *before)
{
	const struct ows_image_header *h;

	if (segment_open_old(instance, SEGMENT_IMAGE, before))
		return false;
	h = (const void *)before->base;
	if (before->size >= sizeof(*h) && h->magic == OWS_IMAGE_MAGIC)
		return true;
	segment_close(before);
	return false;
}

/* The way to the served protocol: the socket, else an address of this machine; NULL: none. */
static const char *served_target(const struct config_serve *serve, char *text, size_t size)
{
	static const uint8_t loopback[2][16] = {{127, 0, 0, 1}, {[15] = 1}};
	static const uint8_t any[16] = {0};
	struct listen_address address;
	char where[LISTEN_TEXT_MAX];

	if (serve->socket) {
		snprintf(text, size, "owserver:%s", serve->socket);
		return text;
	}
	if (!serve->address_count || !serve->addresses[0].port)
		return NULL;
	address = serve->addresses[0];
	if (!memcmp(address.bytes, any, sizeof(any)))
		memcpy(address.bytes, loopback[address.is_v6], sizeof(any));
	listen_print(&address, where);
	snprintf(text, size, "%s", where);
	return text;
}

static int make_image(struct memory *m, const struct image_counter *counters,
                      uint32_t counter_count)
{
	const struct config *config = m->config;
	struct image_signal *signals = calloc((size_t)config->item_count + 1, sizeof(*signals));
	const char *targets[CONFIG_TARGETS_MAX];
	uint32_t groups[CONFIG_TARGETS_MAX];
	char served[160];
	struct image_plan plan = {
		.signals = signals,
		.signal_count = config->item_count,
		.served = served_target(&config->serve, served, sizeof(served)),
		.targets = targets,
		.target_count = config->target_count,
		.groups = groups,
		.counters = counters,
		.counter_count = counter_count,
		.generation = m->generation,
		.start_id = m->start_id,
		.pid = getpid(),
		.start_ns = m->start_ns,
		.start_wall_ns = m->start_wall_ns,
		.period_ns = config->period_ns,
	};
	size_t size;
	int err = -ENOMEM;

	if (signals) {
		for (unsigned i = 0; i < config->item_count; i++)
			signal_table_image(&config->items[i], &signals[i]);
		for (unsigned i = 0; i < config->target_count; i++) {
			targets[i] = config->targets[i].text;
			groups[i] = config->targets[i].group;
		}
		size = image_size(&plan);
		err = size ? segment_create(m->instance, SEGMENT_IMAGE, size, &m->image_segment)
		           : -EFBIG;
	}
	if (!err)
		image_build(&plan, m->image_segment.base, &m->image);
	free(signals);
	return err;
}

static int make_commands(struct memory *m, struct memory_commands *to)
{
	const struct config *config = m->config;
	struct command_signal *signals = calloc((size_t)config->item_count + 1, sizeof(*signals));
	struct command_plan plan = {
		.signals = signals,
		.signal_count = config->item_count,
		.text_cap = TABLE_TEXT_CAP,
		.generation = m->generation,
		.start_id = m->start_id,
		.pid = getpid(),
	};
	int err;

	if (!signals)
		return -ENOMEM;
	for (unsigned i = 0; i < config->item_count; i++)
		signals[i] = (struct command_signal){.name = config->items[i].name,
		                                     .path = config->items[i].path,
		                                     .type = (uint8_t)config->items[i].type};
	err = segment_create(m->instance, SEGMENT_COMMAND, commands_size(&plan), &to->segment);
	if (!err)
		err = segment_guard(&to->segment);
	if (!err)
		err = commands_build(&plan, to->segment.base, &to->commands);
	free(signals);
	return err;
}

/*
 * Carry the commands over from the segment of the previous owsd. Once that segment is RETIRED, sets
 * fail there, so no command is lost between the two segments.
 */
static void carry_commands(struct memory *m, struct log *log)
{
	struct segment before;
	int carried, err;

	err = segment_open_old(m->instance, SEGMENT_COMMAND, &before);
	if (err) {
		if (err != -ENOENT)
			log_warning(log, "earlier commands are not taken over: %s", strerror(-err));
		return;
	}
	if (segment_guard(&before) == 0) {
		commands_retire(before.base, before.size);
		carried = commands_carry(memory_commands(m), before.base, before.size, true);
		if (carried < 0)
			log_warning(log, "earlier commands are not taken over: the old "
			                 "command segment is damaged");
	}
	segment_close(&before);
}

int memory_make(struct memory *m, const struct memory_setup *setup, char *why, size_t why_size)
{
	char hint[SEGMENT_HINT];
	struct segment before;
	int err;

	*m = (struct memory){.instance = setup->instance, .config = setup->config};
	m->image_segment.fd = -1;
	for (unsigned i = 0; i < COMMANDS; i++)
		m->commands[i].segment.fd = -1;
	m->start_id = random_id();
	m->start_ns = setup->before ? setup->before->start_ns : ows_now();
	m->start_wall_ns = setup->before ? setup->before->start_wall_ns : wall_ns();
	if (setup->before) {
		m->generation = setup->before->generation + 1;
	} else if (open_image_before(m->instance, &before)) {
		m->generation = ((struct ows_image_header *)(void *)before.base)->generation + 1;
		segment_close(&before);
	} else {
		m->generation =
			m->start_id; /* a new number, even if the image before was removed */
	}
	err = make_image(m, setup->counters, setup->counter_count);
	if (!err)
		err = make_commands(m, &m->commands[0]);
	if (err) {
		snprintf(why, why_size, "cannot make the shared memory: %s%s", strerror(-err),
		         segment_hint(m->instance, err, hint));
		memory_end(m);
		return err;
	}
	if (!setup->before)
		carry_commands(m, setup->log);
	return 0;
}

static bool is_private(const struct segment *segment)
{
	struct stat st;

	return fstat(segment->fd, &st) == 0 && (st.st_mode & S_IRWXG) == 0;
}

/*
 * Log that no group may use the segments: intended when a user starts owsd by hand, a fault in the
 * service, whose consumers could not open them.
 */
static void report_private(const struct memory *m, struct log *log)
{
	bool image = is_private(&m->image_segment);

	if ((image || is_private(&m->commands[m->current].segment)) && owner_is_service())
		log_warning(
			log,
			"no other user can %s: the shared memory cannot be given to the group %s: "
			"is there one, and is the user owsd in it?",
			image ? "look at the signals" : "set outputs",
			image ? "owsd" : "owsd-control");
}

static bool process_exists(int32_t pid)
{
	return pid > 0 && (kill(pid, 0) == 0 || errno != ESRCH);
}

static void retire_image(struct segment *before, struct log *log)
{
	struct ows_image_header *h = (void *)before->base;
	uint32_t state = __atomic_load_n(&h->state, __ATOMIC_RELAXED);

	if (state == OWS_STATE_LIVE && h->pid != getpid())
		log_notice(log, "taken over from owsd %d, which had not stopped%s", (int)h->pid,
		           process_exists(h->pid) ? "; there is still a process of that number"
		                                  : "");
	image_retire(before->base, before->size);
	segment_wake(&h->news, INT_MAX);
}

int memory_show(struct memory *m, struct log *log, char *why, size_t why_size)
{
	char hint[SEGMENT_HINT];
	struct segment before;
	bool had_before = open_image_before(m->instance, &before);
	int err;

	image_state(&m->image, OWS_STATE_LIVE);
	commands_state(memory_commands(m), OWS_STATE_LIVE);
	err = segment_show(m->instance, &m->commands[m->current].segment);
	if (!err)
		err = segment_show(m->instance, &m->image_segment);
	if (err)
		snprintf(why, why_size,
		         "no program sees the values: cannot put the shared memory in place: %s%s",
		         strerror(-err), segment_hint(m->instance, err, hint));
	m->shown = !err;
	if (!err)
		report_private(m, log);
	if (had_before && !err)
		retire_image(&before, log);
	if (had_before)
		segment_close(&before);
	return err;
}

struct commands *memory_commands(struct memory *m)
{
	return &m->commands[m->current].commands;
}

bool memory_commands_lost(const struct memory *m)
{
	const struct segment *segment = &m->commands[m->current].segment;

	return segment_lost(segment) || !segment_named(m->instance, segment);
}

bool memory_image_lost(const struct memory *m)
{
	return !segment_named(m->instance, &m->image_segment);
}

static void release_commands(struct memory_commands *c)
{
	segment_close(&c->segment);
	commands_forget(&c->commands);
}

struct commands *memory_renew_commands(struct memory *m, int *err)
{
	unsigned next = (m->current + 1) % COMMANDS;
	struct memory_commands *to = &m->commands[next];

	release_commands(to);
	*err = make_commands(m, to);
	if (*err) {
		release_commands(to);
		return NULL;
	}
	/*
	 * consumers that still map the old segment read in its state that they have to open the new
	 * one
	 */
	commands_state(memory_commands(m), OWS_STATE_RETIRED);
	m->current = next;
	return &to->commands;
}

int memory_show_commands(struct memory *m)
{
	commands_state(memory_commands(m), OWS_STATE_LIVE);
	return segment_show(m->instance, &m->commands[m->current].segment);
}

void memory_replaced(struct memory *m)
{
	/* an image that had lost its name is not retired yet: its readers would keep it for ever */
	if (__atomic_load_n(&m->image.header->state, __ATOMIC_RELAXED) != OWS_STATE_RETIRED) {
		image_retire(m->image_segment.base, m->image_segment.size);
		segment_wake(&m->image.header->news, INT_MAX);
	}
	m->shown = false;
	memory_end(m);
}

void memory_stop(struct memory *m)
{
	if (!m->shown)
		return;
	image_state(&m->image, OWS_STATE_STOPPED);
	segment_wake(&m->image.header->news, INT_MAX);
	commands_repair(memory_commands(m), true);
	commands_state(memory_commands(m), OWS_STATE_STOPPED);
	m->shown = false;
}

void memory_end(struct memory *m)
{
	if (!m->instance)
		return;
	memory_stop(m);
	segment_close(&m->image_segment);
	for (unsigned i = 0; i < COMMANDS; i++)
		release_commands(&m->commands[i]);
}
