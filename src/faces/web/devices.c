/* SPDX-License-Identifier: MIT */
/* Scans the buses of owsd by its socket NAME.sock, on a worker, by several connections at once. */
#include <errno.h>
#include <microhttpd.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "hal/owfs/path.h"
#include "src/faces/show/json.h"
#include "src/faces/web/guard.h"
#include "src/faces/web/http.h"
#include "src/faces/web/paths.h"
#include "src/faces/web/person.h"
#include "src/ground/signal/error.h"
#include "src/ground/signal/value.h"
#include "src/memory/libows/open.h"
#include "src/tool/scan/scan.h"
#include "src/tool/scan/target.h"

#define ALL_NS (30 * NS_PER_S) /* from the request to the answer */
#define EACH_NS (10 * NS_PER_S)
#define IDS 128
#define READERS 8 /* connections: what waits for conversions does so at the same time */

struct devices {
	struct job job;
	char instance[128], target[224];
	int64_t until_ns;
	unsigned id_count;
	char id[IDS][ROM_TEXT_MAX];
	struct ows *h;
	struct scan scan;
	bool whole; /* all was asked in time */
};

/* --- The answer ------------------------------------------------------------------------------ */

/* The signals of a device; another way to it is the same device. */
static void put_signals(struct json *json, const struct ows *h, const uint8_t rom[ROM_LEN])
{
	struct ows_info info;
	struct path path;

	json_array(json, "signals");
	for (int i = 0; ows_info(h, i, &info) == 0; i++)
		if (!path_split(info.path, strlen(info.path), &path) && path.has_rom &&
		    !memcmp(path.rom, rom, ROM_LEN))
			json_string(json, NULL, info.name);
	json_array_end(json);
}

static void put_properties(struct json *json, const struct scan_device *device)
{
	struct scan_property property;
	char words[ERROR_WORDS];

	json_array(json, "properties");
	for (unsigned i = 0; scan_property(device, i, &property); i++) {
		const struct scan_value *value = &device->value[i];

		/* of another chip with the same family code */
		if (value->err == -ENOENT)
			continue;
		json_object(json, NULL);
		json_string(json, "name", property.name);
		json_string(json, "word", property.word);
		json_string(json, "type", value_type_name(property.type));
		json_bool(json, "output", property.output);
		json_string(json, "value", value->err ? NULL : value->text);
		json_string(json, "why",
		            value->err ? error_answer_words(value->err, value->refused, words)
		                       : NULL);
		json_object_end(json);
	}
	json_array_end(json);
}

static void put_device(struct json *json, const struct ows *h, const struct scan_device *device)
{
	char id[ROM_TEXT_MAX], family[4];
	struct path path;

	if (path_split(device->path, strlen(device->path), &path) || !path.has_rom)
		return;
	rom_print(path.rom, ROM_F_I, id);
	snprintf(family, sizeof(family), "%02X", device->family);
	json_object(json, NULL);
	json_string(json, "id", id);
	json_string(json, "path", device->path);
	json_string(json, "location", device->location[0] ? device->location : NULL);
	json_string(json, "family", family);
	json_string(json, "type", device->type[0] ? device->type : NULL);
	json_string(json, "identity", device->identity[0] ? device->identity : NULL);
	json_string(json, "alias", device->alias[0] ? device->alias : NULL);
	json_bool(json, "simulated", device->simulated);
	put_signals(json, h, path.rom);
	put_properties(json, device);
	json_object_end(json);
}

static void devices_answer(struct devices *devices)
{
	struct json json;

	if (!json_start(&json, &devices->job.text, &devices->job.len))
		return;
	devices->job.status = 200;
	json_bool(&json, "whole", devices->whole);
	json_array(&json, "devices");
	for (unsigned i = 0; i < devices->scan.count; i++)
		put_device(&json, devices->h, &devices->scan.device[i]);
	json_array_end(&json);
	json_finish(&json);
}

/* --- The scan -------------------------------------------------------------------------------- */

struct reader {
	pthread_t thread;
	bool started;
	const struct devices *of;
	struct scan_device *first;
	unsigned count;
	int err;
};

static struct target target_of(const struct devices *devices)
{
	return (struct target){.create = owserver_bus.create, /* no driver is in owsd-web */
	                       .name = devices->target,
	                       .timeout_ns = EACH_NS,
	                       .until_ns = devices->until_ns};
}

/* While owsd finds out what its chips are, an answer may take longer than a connection waits. */
static int connect_in_time(struct target *target, char *why, size_t why_size)
{
	int err;

	do
		err = target_connect(target, why, why_size);
	while (err == -ENOTCONN && ows_now() < target->until_ns - ALL_NS / 2 &&
	       usleep(200 * 1000) == 0);
	return err;
}

static void *read_some(void *ctx)
{
	struct reader *reader = ctx;
	struct target target = target_of(reader->of);
	char why[300];

	reader->err = connect_in_time(&target, why, sizeof(why));
	if (reader->err) {
		for (unsigned i = 0; i < reader->count; i++)
			for (unsigned k = 0; k < SCAN_PROPERTIES; k++)
				reader->first[i].value[k].err = reader->err;
		return NULL;
	}
	reader->err = scan_read(&target, reader->first, reader->count, reader->of->id_count > 0);
	target_close(&target);
	return NULL;
}

static void read_all(struct devices *devices)
{
	struct reader readers[READERS] = {0};
	unsigned n = devices->scan.count < READERS ? devices->scan.count : READERS, given = 0;

	devices->whole = true;
	for (unsigned i = 0; i < n; i++) {
		readers[i].of = devices;
		readers[i].first = devices->scan.device + given;
		readers[i].count = (devices->scan.count - given) / (n - i);
		given += readers[i].count;
		readers[i].started = pthread_create(&readers[i].thread, NULL, read_some,
		                                    &readers[i]) == 0;
		if (!readers[i].started)
			read_some(&readers[i]);
	}
	for (unsigned i = 0; i < n; i++) {
		if (readers[i].started)
			pthread_join(readers[i].thread, NULL);
		devices->whole &= !readers[i].err;
	}
}

/* The devices of ids=, without a listing. */
static int take_ids(struct devices *devices)
{
	char path[ROM_TEXT_MAX + 1];

	devices->scan.device = calloc(devices->id_count, sizeof(*devices->scan.device));
	if (!devices->scan.device)
		return -ENOMEM;
	for (unsigned i = 0; i < devices->id_count; i++) {
		snprintf(path, sizeof(path), "/%s", devices->id[i]);
		devices->scan.count += scan_device_of(path,
		                                      &devices->scan.device[devices->scan.count]);
	}
	return 0;
}

static void scan(struct devices *devices)
{
	struct target target = target_of(devices);
	char why[300], words[ERROR_WORDS];
	int err = 0;

	if (devices->id_count) {
		err = take_ids(devices);
	} else {
		err = connect_in_time(&target, why, sizeof(why));
		if (err) {
			job_error(&devices->job, 503, "owsd: %s", why);
			return;
		}
		err = scan_find(&target, &devices->scan);
		target_close(&target);
	}
	if (err) {
		job_error(&devices->job, err == -ENOMEM ? 500 : 503,
		          "the buses of owsd cannot be listed: %s", error_words(err, words));
		return;
	}
	read_all(devices);
	devices_answer(devices);
}

/* NAME.sock, else what the configuration serves. False after answering. */
static bool find_target(struct devices *devices)
{
	int n = snprintf(devices->target, sizeof(devices->target), "%s/%s.sock",
	                 open_place(devices->h), devices->instance);
	const char *served = ows_served(devices->h);

	if (n < (int)sizeof(devices->target) && access(devices->target, R_OK | W_OK) == 0)
		return true;
	if (served && !strncmp(served, "owserver:", 9))
		served += 9;
	if (served) {
		snprintf(devices->target, sizeof(devices->target), "%s", served);
		return true;
	}
	job_error(&devices->job, 503,
	          "owsd does not let owsd-web look for devices at %s: does it run, and is the user "
	          "of owsd-web in the group owsd-config?",
	          devices->target);
	return false;
}

static void devices_run(struct job *job)
{
	struct devices *devices = (struct devices *)job;

	if (ows_now() >= devices->until_ns - NS_PER_S)
		job_error(job, 503, "another scan takes long: try again in a moment");
	else if (ows_open_as(devices->instance, OWS_READ, "owsd-web", &devices->h))
		job_error(job, 503, "owsd %s is not there: start it", devices->instance);
	else if (find_target(devices))
		scan(devices);
	ows_close(devices->h);
	scan_free(&devices->scan);
}

/* --- The request ----------------------------------------------------------------------------- */

/* "28.551DDF030000,28.67C6697351FF". False: one of them is no id, or there are too many. */
static bool parse_ids(const char *text, struct devices *devices)
{
	uint8_t rom[ROM_LEN];

	while (*text) {
		size_t len = strcspn(text, ",");

		if (devices->id_count == IDS || rom_parse(text, len, rom))
			return false;
		rom_print(rom, ROM_F_I, devices->id[devices->id_count++]);
		text += len + (text[len] == ',');
	}
	return devices->id_count > 0;
}

int devices_get(struct request *request)
{
	struct web *web = request->web;
	const char *ids = http_argument(request, "ids");
	struct devices *devices;
	char person[PERSON], words[GUARD_WORDS];
	/* it loads the wire */
	unsigned status = guard_person(request, PERSON_CONFIGURE, person, words);

	if (status)
		return http_error(request, status, "%s", words);
	devices = (struct devices *)http_job(request, sizeof(*devices), devices_run);
	if (!devices)
		return MHD_NO;
	snprintf(devices->instance, sizeof(devices->instance), "%s",
	         web->face->arguments->instance);
	devices->until_ns = ows_now() + ALL_NS;
	if (ids && !parse_ids(ids, devices)) {
		job_free(&devices->job);
		return http_error(request, 400,
		                  "ids=: expected ids of at most %d devices, with commas between",
		                  IDS);
	}
	return http_defer(request, http_worker(web, &web->scans), &devices->job);
}
