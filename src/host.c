/* SPDX-License-Identifier: MIT */
#include "host_private.h"

#include "hal/worker.h"
#include "indicator.h"
#include "libows/ows.h"
#include "serve/serve.h"
#include "shm/reader.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A consumer that takes the command segment away again and again has one made once a second. */
#define TEND_NS    1000000000
/* How often the loss of the image is said. */
#define IMAGE_LOST_NS 60000000000LL

static int show_renewed(struct host *h)
{
	int err = memory_show_commands(&h->now->memory);

	if (!err)
		h->unseen = false;
	return err;
}

static int renew_commands(struct host *h)
{
	struct commands *renewed;
	int err = 0;

	renewed = memory_renew_commands(&h->now->memory, &err);
	if (!renewed)
		return err;
	h->unseen = true;
	__atomic_store_n(&h->renewed, renewed, __ATOMIC_RELEASE);
	host_ring(h);
	return 0;
}

/* An image of the same values under the name would need all readers to open it: a restart's work. */
static void look_for_image(struct host *h, int64_t now_ns)
{
	if ((h->image_lost_ns && now_ns - h->image_lost_ns < IMAGE_LOST_NS) ||
	    !memory_image_lost(&h->now->memory))
		return;
	h->image_lost_ns = now_ns;
	log_err(h->log,
	        "/dev/shm/owsd.%s.image was removed and programs that start now do not find it: "
	        "restart owsd (of an ordinary user, logind's RemoveIPC= removes it at log-out)",
	        h->instance);
}

void host_tend(struct host *h)
{
	int64_t now_ns = ows_now();
	int err = 0;

	look_for_image(h, now_ns);
	if (__atomic_load_n(&h->renewed, __ATOMIC_ACQUIRE)) /* the engine has not filled it yet */
		return;
	if (now_ns < h->tend_ns)
		return;
	if (h->unseen) {
		err = show_renewed(h);
		h->tend_ns = now_ns + TEND_NS;
	} else if (memory_commands_lost(&h->now->memory)) {
		err = renew_commands(h);
		h->tend_ns = err ? now_ns + TEND_NS : 0;
	}
	if (err)
		log_err(h->log, "the command segment was taken away and cannot be made again: %s",
		        strerror(-err));
}

int host_make_serving(struct host *h, struct config *config, const struct adoption *plan,
                      struct serving **serving, char *why, size_t why_size)
{
	struct serving_setup setup = {
		.config = config,
		.instance = h->instance,
		.log = h->log,
		.ring = host_ring,
		.ring_ctx = h,
		.guests = h->serve ? serve_guests(h->serve) : NULL,
		.before = h->now,
		.plan = plan,
	};
	struct image_counter *counters = host_plan_counters(h, &setup.counter_count);
	int err = -ENOMEM;

	snprintf(why, why_size, "%s", strerror(ENOMEM));
	*serving = calloc(1, sizeof(**serving));
	setup.counters = counters;
	if (counters && *serving)
		err = serving_make(*serving, &setup, why, why_size);
	free(counters);
	if (!err)
		return 0;
	free(*serving);
	*serving = NULL;
	return err;
}

static void free_host(struct host *h)
{
	serve_stop(h->serve);
	indicator_destroy(h->indicator);
	if (h->now)
		serving_free(h->now);
	serve_destroy(h->serve);
	free(h->now);
	free(h);
}

static int create_serve(struct host *h, const struct config *config, char *why, size_t why_size)
{
	const struct serve_setup setup = {
		.config = config,
		.instance = h->instance,
		.log = h->log,
		.ring = host_ring,
		.ring_ctx = h,
	};

	if (!config->serve.address_count && !config->serve.socket)
		return 0;
	if (serve_is_open(&config->serve))
		log_warning(h->log,
		            "the owserver protocol is served beyond this machine and lets %s write: "
		            "see ListenAllow and ListenReadOnly",
		            config->serve.peer_count ? "all of ListenAllow" : "everybody");
	return serve_create(&setup, &h->serve, why, why_size);
}

int host_start_indicator(struct host *h, char *why, size_t why_size)
{
	int err = indicator_create(h->now->config, &h->now->memory.image, h->log, &h->indicator);

	if (!err)
		err = indicator_start(h->indicator);
	if (err)
		snprintf(why, why_size, "cannot start a thread: %s", strerror(-err));
	return err;
}

int host_start_workers(struct serving *s, const struct adoption *plan, char *why, size_t why_size)
{
	for (unsigned i = 0; i < s->worker_count; i++) {
		int err = plan && plan->ports[i] >= 0 ? 0 : worker_start(s->workers[i]);

		if (err) {
			snprintf(why, why_size, "cannot start a worker: %s", strerror(-err));
			return err;
		}
	}
	return 0;
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
	err = create_serve(h, setup->config, why, why_size);
	if (!err)
		err = host_make_serving(h, setup->config, NULL, &h->now, why, why_size);
	if (err) {
		free_host(h); /* the server's socket has its path in the configuration */
		config_free(setup->config);
		return err;
	}
	err = memory_show(&h->now->memory, h->log);
	if (err) {
		snprintf(why, why_size, "cannot put the shared memory in place: %s",
		         strerror(-err));
		goto fail;
	}
	h->bell = commands_bell(h->now->commands);
	err = host_start_engine(h, setup->rt_priority, why, why_size);
	if (err)
		goto fail;
	err = host_start_workers(h->now, NULL, why, why_size);
	if (!err && h->serve) {
		err = serve_start(h->serve, &h->now->memory.image);
		if (err)
			snprintf(why, why_size, "cannot serve the owserver protocol: %s",
			         strerror(-err));
	}
	if (!err)
		err = host_start_indicator(h, why, why_size);
	if (err) {
		host_stop(h, 1000000000);
		return err;
	}
	*host = h;
	return 0;
fail:
	free_host(h);
	return err;
}

int64_t host_beat(const struct host *host)
{
	struct ows_sample sample;

	return reader_sample(&host->now->memory.image.records[0], &sample) ? sample.measured_ns : 0;
}

const struct config *host_config(const struct host *host)
{
	return host->now->config;
}

bool host_stop(struct host *h, int64_t timeout_ns)
{
	bool stuck = false;

	/* first what others could wait for: ports and clients */
	serve_stop(h->serve);
	__atomic_store_n(&h->stop, 1, __ATOMIC_RELEASE);
	if (h->running) {
		host_ring(h);
		pthread_join(h->thread, NULL);
	}
	stuck = !indicator_stop(h->indicator, timeout_ns) || h->left_behind;
	stuck |= !serving_stop(h->now, timeout_ns);
	if (stuck) {
		/* who comes back from the kernel now still rings in it, and looks at it */
		memory_stop(&h->now->memory);
		return false;
	}
	free_host(h);
	return true;
}
