/* SPDX-License-Identifier: MIT */
/* The files of a running owsd that belong to a configuration: made, shown and retired. */
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/daemon/engine/table.h"
#include "src/daemon/host/memory.h"
#include "src/ground/signal/hash.h"
#include "src/memory/shm/entries.h"
#include "src/memory/shm/hint.h"
#include "src/memory/shm/owner.h"
#include "src/memory/shm/porter.h"
#include "src/memory/shm/shelves.h"
#include "src/public/ows.h"

#define BOOT_ID "/proc/sys/kernel/random/boot_id"

static uint32_t random_id(void)
{
	uint32_t id = 0;

	if (getrandom(&id, sizeof(id), GRND_NONBLOCK) != (ssize_t)sizeof(id))
		id = (uint32_t)clock_ns(CLOCK_REALTIME) ^ (uint32_t)getpid();
	return id | 1;
}

/* Open the image that the previous owsd left, if this owsd may mark it retired. */
static bool open_image_before(const struct memory *m, struct segment *before)
{
	const struct ows_image_header *h;

	if (segment_open_old(m->dir, m->instance, SEGMENT_IMAGE, before))
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

/* How many lines of the log consumers see: some minutes of trouble, and 18 KB. */
#define LOG_LINES 64

static int make_image(struct memory *m, const struct image_counter *counters,
                      uint32_t counter_count)
{
	const struct config *config = m->config;
	struct image_signal *signals = calloc((size_t)config->item_count + 1, sizeof(*signals));
	struct image_meta *metas = calloc((size_t)config->item_count + 1, sizeof(*metas));
	uint32_t *devices = calloc((size_t)config->item_count + 1, sizeof(*devices));
	int device_count = devices ? table_image_devices(config, devices) : -ENOMEM;
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
		.devices = devices,
		.device_count = device_count < 0 ? 0 : (uint32_t)device_count,
		.log_lines = LOG_LINES,
		.generation = m->generation,
		.start_id = m->start_id,
		.pid = getpid(),
		.start_ns = m->start_ns,
		.start_wall_ns = m->start_wall_ns,
		.period_ns = config->period_ns,
	};
	size_t size;
	int err = -ENOMEM;

	if (signals && metas && device_count >= 0) {
		for (unsigned i = 0; i < config->item_count; i++) {
			signal_table_image(&config->items[i], &signals[i]);
			signal_table_meta(&config->items[i], &metas[i]);
			signals[i].meta = &metas[i];
		}
		for (unsigned i = 0; i < config->target_count; i++) {
			targets[i] = config->targets[i].text;
			groups[i] = config->targets[i].group;
		}
		size = image_size(&plan);
		err = size ? segment_create(m->dir, m->instance, SEGMENT_IMAGE, size,
		                            &m->image_segment)
		           : -EFBIG;
	}
	if (!err)
		image_build(&plan, m->image_segment.base, &m->image);
	free(signals);
	free(metas);
	free(devices);
	return err;
}

/* A number of this boot of the machine: what was left by another boot is not in force. */
static uint64_t boot_number(void)
{
	FILE *file = fopen(BOOT_ID, "re");
	uint64_t number = 1;
	int c;

	while (file && (c = fgetc(file)) != EOF)
		number = hash_text(number, &(char){(char)c}, 1);
	if (file)
		fclose(file);
	return number;
}

static int make_force(struct memory *m, uint64_t boot)
{
	const struct config *config = m->config;
	struct force_signal *signals = calloc((size_t)config->item_count + 1, sizeof(*signals));
	const struct force_plan plan = {
		.signals = signals,
		.signal_count = config->item_count,
		.text_cap = TABLE_TEXT_CAP,
		.boot = boot,
	};
	size_t size;
	int err;

	if (!signals)
		return -ENOMEM;
	for (unsigned i = 0; i < config->item_count; i++)
		signals[i] = (struct force_signal){.name = config->items[i].name,
		                                   .path = config->items[i].path,
		                                   .type = (uint8_t)config->items[i].type};
	size = force_size(&plan);
	err = size ? segment_create(m->dir, m->instance, SEGMENT_FORCE, size, &m->force_segment)
	           : -EFBIG;
	if (!err)
		force_build(&plan, m->force_segment.base, &m->force);
	free(signals);
	return err;
}

static int make_layout(struct memory *m)
{
	const struct config *config = m->config;
	uint8_t *types = calloc((size_t)config->item_count + 1, 1);
	const struct controller_plan plan = {
		.types = types,
		.signal_count = config->item_count,
		.text_cap = TABLE_TEXT_CAP,
		.generation = m->generation,
		.start_id = m->start_id,
	};
	int err;

	if (!types)
		return -ENOMEM;
	for (unsigned i = 0; i < config->item_count; i++)
		types[i] = (uint8_t)config->items[i].type;
	err = controller_layout_make(&m->layout, &plan);
	free(types);
	return err;
}

/* What the owsd before has left; nothing after a boot. */
static void open_left(struct memory *m, uint64_t boot, struct log *log)
{
	int err = segment_open_old(m->dir, m->instance, SEGMENT_FORCE, &m->left_segment);

	if (err == -ENOENT)
		return;
	if (!err)
		err = force_open(m->left_segment.base, m->left_segment.size, boot, &m->left);
	m->has_left = !err;
	if (m->has_left)
		return;
	segment_close(&m->left_segment);
	if (err != -ESTALE)
		log_warning(log, "owsd does not know which commands are in force: %s",
		            err == -EPROTO ? "what the owsd before has left is damaged"
		                           : strerror(-err));
}

void memory_resumed(struct memory *m)
{
	if (m->has_left)
		force_close(&m->left);
	segment_close(&m->left_segment);
	m->has_left = false;
}

int memory_make(struct memory *m, const struct memory_setup *setup, char *why, size_t why_size)
{
	char hint[SEGMENT_HINT];
	uint64_t boot = boot_number();
	struct segment before;
	bool has_before;
	int err;

	*m = (struct memory){.instance = setup->instance,
	                     .dir = setup->dir,
	                     .config = setup->config,
	                     .porter = setup->porter};
	m->image_segment.fd = m->force_segment.fd = m->left_segment.fd = -1;
	m->start_id = random_id();
	m->start_ns = setup->before ? setup->before->start_ns : ows_now();
	m->start_wall_ns = setup->before ? setup->before->start_wall_ns : clock_ns(CLOCK_REALTIME);
	has_before = !setup->before && open_image_before(m, &before);
	m->generation = m->start_id; /* a new number, even if the image before was removed */
	if (setup->before)
		m->generation = setup->before->generation + 1;
	else if (has_before)
		m->generation = ((struct ows_image_header *)(void *)before.base)->generation + 1;
	err = make_image(m, setup->counters, setup->counter_count);
	if (!err)
		err = make_force(m, boot);
	if (!err)
		err = make_layout(m);
	if (!err && has_before)
		shelves_carry(&m->image, before.base, before.size, NULL);
	if (has_before)
		segment_close(&before);
	if (err) {
		snprintf(why, why_size, "cannot make the shared memory: %s%s", strerror(-err),
		         segment_hint(m->dir, m->instance, err, hint));
		memory_end(m);
		return err;
	}
	if (setup->before)
		image_carry_log(&m->image, &setup->before->image);
	else
		open_left(m, boot, setup->log);
	return 0;
}

static bool is_private(const struct segment *segment)
{
	struct stat st;

	return fstat(segment->fd, &st) == 0 && (st.st_mode & S_IRWXG) == 0;
}

/*
 * Log that no group may look or command: intended when a user starts owsd by hand, a fault in the
 * service.
 */
static void report_private(const struct memory *m, struct log *log)
{
	bool image = is_private(&m->image_segment);
	gid_t gid;

	if (!owner_is_service() ||
	    (!image && (m->config->allow_count || owner_group("owsd-control", &gid))))
		return;
	if (image)
		log_warning(log, "no other user can look at the signals: the image cannot be given "
		                 "to the group owsd: is there one, and is the user owsd in it?");
	else
		log_warning(log, "no other user can set outputs: there is no group owsd-control");
}

static bool process_exists(int32_t pid)
{
	return pid > 0 && (kill(pid, 0) == 0 || errno != ESRCH);
}

/* They may be many, and of others: so it is no work for the thread that reloads. */
static void wake_sleepers(const struct memory *m, const struct segment *image)
{
	const struct porter_order order = {.what = PORTER_WAKE,
	                                   .count = 1,
	                                   .keep = 1,
	                                   .slot = PORTER_NO_SLOT,
	                                   .fds = {image->fd}};

	/* else they sleep for a second at most */
	porter_give(m->porter, PORTER_NEWS, &order);
}

static void retire_image(const struct memory *m, struct segment *before, struct log *log)
{
	struct ows_image_header *h = (void *)before->base;
	uint32_t state = __atomic_load_n(&h->state, __ATOMIC_RELAXED);

	if (state == OWS_STATE_LIVE && h->pid != getpid())
		log_notice(log, "taken over from owsd %d, which had not stopped%s", (int)h->pid,
		           process_exists(h->pid) ? "; there is still a process of that number"
		                                  : "");
	image_retire(before->base, before->size);
	wake_sleepers(m, before);
}

int memory_show(struct memory *m, struct log *log, char *why, size_t why_size)
{
	char hint[SEGMENT_HINT];
	struct segment before;
	bool had_before = open_image_before(m, &before);
	int err;

	image_state(&m->image, OWS_STATE_LIVE);
	err = segment_show(m->instance, &m->force_segment);
	if (!err)
		err = segment_show(m->instance, &m->image_segment);
	if (err)
		snprintf(why, why_size,
		         "no program sees the values: cannot put the shared memory in place: %s%s",
		         strerror(-err), segment_hint(m->dir, m->instance, err, hint));
	m->shown = !err;
	if (!err)
		report_private(m, log);
	if (had_before && !err)
		retire_image(m, &before, log);
	if (had_before)
		segment_close(&before);
	return err;
}

bool memory_image_lost(const struct memory *m)
{
	return !segment_named(m->instance, &m->image_segment);
}

void memory_replaced(struct memory *m)
{
	/* an image that had lost its name is not retired yet: its readers would keep it for ever */
	if (__atomic_load_n(&m->image.header->state, __ATOMIC_RELAXED) != OWS_STATE_RETIRED) {
		image_retire(m->image_segment.base, m->image_segment.size);
		wake_sleepers(m, &m->image_segment);
	}
	m->shown = false;
	memory_end(m);
}

void memory_stop(struct memory *m)
{
	if (!m->shown)
		return;
	image_state(&m->image, OWS_STATE_STOPPED);
	wake_sleepers(m, &m->image_segment);
	m->shown = false;
}

void memory_end(struct memory *m)
{
	if (!m->instance)
		return;
	memory_stop(m);
	memory_resumed(m);
	segment_close(&m->image_segment);
	segment_close(&m->force_segment);
	controller_layout_free(&m->layout);
}
