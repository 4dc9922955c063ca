/* SPDX-License-Identifier: MIT */
/*
 * Starts and stops the parts of owsd: memory, engine, workers, the served protocol, the indicator.
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/config/read/load.h"
#include "src/daemon/host/engine_thread.h"
#include "src/daemon/host/host.h"
#include "src/daemon/host/indicator.h"
#include "src/daemon/host/last.h"
#include "src/daemon/host/make.h"
#include "src/daemon/host/private.h"
#include "src/daemon/serve/serve.h"
#include "src/memory/control/control.h"
#include "src/memory/shm/entries.h"
#include "src/memory/shm/reader.h"

static void free_host(struct host *h)
{
	serve_stop(h->serve);
	control_destroy(h->control);
	indicator_destroy(h->indicator);
	if (h->now)
		serving_free(h->now);
	serve_destroy(h->serve);
	bells_close(&h->bells);
	free(h->now);
	free(h);
}

static int create_serve(struct host *h, const struct config *config, char *why, size_t why_size)
{
	const struct serve_setup setup = {
		.config = config,
		.instance = h->instance,
		.dir = h->dir->path,
		.directory = h->dir->fd,
		.log = h->log,
		.porter = h->porter,
		.ring = host_ring,
		.ring_ctx = h,
	};

	if (serve_is_open(&config->serve))
		log_warning(
			h->log,
			"the owserver protocol is served beyond this machine and lets %s write: "
			"see ListenAllow and ListenReadOnly",
			config->serve.peer_count ? "all of ListenAllow" : "everybody");
	return serve_create(&setup, &h->serve, why, why_size);
}

static int create_control(struct host *h, const struct config *config, char *why, size_t why_size)
{
	const struct control_setup setup = {
		.config = config,
		.directory = h->dir->fd,
		.instance = h->instance,
		.log = h->log,
		.porter = h->porter,
		.ring = host_ring,
		.ring_ctx = h,
	};

	return control_create(&setup, &h->control, why, why_size);
}

/* The threads beside the engine's, which runs: the server connects to the control room. */
static int start_rest(struct host *h, char *why, size_t why_size)
{
	int err = control_start(h->control, &h->now->memory.layout);

	if (err)
		snprintf(why, why_size, "cannot start the threads of the control socket: %s",
		         strerror(-err));
	else
		err = host_start_workers(h->now, why, why_size);
	if (!err) {
		err = last_start(h->now->last);
		if (err)
			snprintf(why, why_size, "cannot start the thread that stores commands: %s",
			         strerror(-err));
	}
	if (!err && h->serve) {
		err = serve_start(h->serve, &h->now->memory.image);
		if (err)
			snprintf(why, why_size, "cannot serve the owserver protocol: %s",
			         strerror(-err));
	}
	return err ? err : host_start_indicator(h, why, why_size);
}

int host_start(const struct host_setup *setup, struct host **host, char *why, size_t why_size)
{
	struct host *h = calloc(1, sizeof(*h));
	int err;

	snprintf(why, why_size, "%s", strerror(ENOMEM));
	if (!h) {
		config_free(setup->config);
		return -ENOMEM;
	}
	h->log = setup->log;
	h->instance = setup->instance;
	h->dir = setup->dir;
	h->porter = setup->porter;
	err = bells_open(&h->bells);
	if (err)
		snprintf(why, why_size, "cannot make the bells of the engine: %s", strerror(-err));
	if (!err)
		err = create_serve(h, setup->config, why, why_size);
	if (!err)
		err = create_control(h, setup->config, why, why_size);
	if (!err)
		err = host_make_serving(h, setup->config, NULL, &h->now, why, why_size);
	if (err) {
		free_host(h); /* the server's socket has its path in the configuration */
		config_free(setup->config);
		return err;
	}
	err = memory_show(&h->now->memory, h->log, why, why_size);
	if (!err)
		err = host_start_engine(h, setup->rt_priority, why, why_size);
	if (err) {
		free_host(h);
		return err;
	}
	err = start_rest(h, why, why_size);
	if (err) {
		host_stop(h, NS_PER_S);
		return err;
	}
	*host = h;
	return 0;
}

static void see_line(void *ctx, int64_t time_ns, enum log_level level, const char *text, size_t len)
{
	struct host *h = ctx;

	image_log(&h->now->memory.image, time_ns, level, text, len);
}

void host_show_log(struct host *host, bool on)
{
	log_show(host->log, on ? see_line : NULL, host);
}

int64_t host_beat(const struct host *host)
{
	struct ows_sample sample;

	return reader_sample(&host->now->memory.image.records[0], &sample) ? sample.measured_ns : 0;
}

int64_t host_beats_apart(const struct host *host)
{
	int64_t period_ns = host->now->config->period_ns;

	return period_ns > ENGINE_BEAT_NS ? period_ns : ENGINE_BEAT_NS;
}

const struct config *host_config(const struct host *host)
{
	return host->now->config;
}

unsigned host_absent(struct host *h, char why[LISTEN_WHY_MAX])
{
	*why = '\0';
	return h->serve ? serve_absent(h->serve, why) : 0;
}

bool host_stop(struct host *h, int64_t timeout_ns)
{
	bool stuck = false;

	/* first the parts that others could wait for: ports and clients */
	serve_stop(h->serve);
	__atomic_store_n(&h->stop, 1, __ATOMIC_RELEASE);
	if (h->running) {
		host_ring(h);
		pthread_join(h->thread, NULL);
	}
	control_stop(h->control);
	stuck = !indicator_stop(h->indicator, timeout_ns) || h->left_behind;
	stuck |= !last_stop(h->now->last, timeout_ns);
	stuck |= !serving_stop(h->now, timeout_ns);
	if (stuck) {
		/* a thread that returns from the kernel later still reads this memory */
		memory_stop(&h->now->memory);
		return false;
	}
	free_host(h);
	return true;
}
