/* SPDX-License-Identifier: MIT */
/* owsctl dir, read and write: what a target has at a path. */
#include <errno.h>
#include <getopt.h>
#include <stdlib.h>
#include <string.h>

#include "src/config/check/shared.h"
#include "src/faces/show/json.h"
#include "src/faces/show/text.h"
#include "src/tool/owsctl/open.h"
#include "src/tool/owsctl/verbs.h"

/* --- The entries of a directory -------------------------------------------------------------- */

#define LISTING_MAX (256u * 1024)

static void print_entries(const struct ctl *ctl, char *text, const char *before)
{
	static char clean[4096], path[4096 + 16];
	struct json json;
	char *rest;

	json_list(&json, stdout, ctl->json);
	for (char *line = strtok_r(text, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest)) {
		/* owserver prefixes its lines with /uncached, owsd's own buses do not */
		bool prefixed = strncmp(line, "/uncached/", 10) == 0;

		if (*before && !strcmp(line, before))
			continue;
		text_clean(line, strlen(line), sizeof(clean), clean, sizeof(clean));
		snprintf(path, sizeof(path), "%s%s", prefixed ? "" : before, clean);
		if (ctl->json)
			json_string(&json, NULL, path);
		else
			puts(path);
	}
	json_list_end(&json);
}

int verb_dir(struct ctl *ctl, int argc, char **argv)
{
	int64_t timeout_ns = OPEN_TIMEOUT_NS;
	struct target target;
	struct served served;
	char path[256];
	bool fresh;
	char *text;
	struct ask ask = {.req = {.op = BUS_DIR, .prio = BUS_GUEST, .path = path}};
	int status;

	target_option(ctl, argc, argv, "", &timeout_ns);
	if (argc - optind > 1)
		return ctl_usage(ctl, "one directory at a time");
	if (!target_path(optind < argc ? argv[optind] : "/", path, &fresh))
		return ctl_usage(ctl, "the path is longer than %d bytes", 255);
	status = open_target(ctl, timeout_ns, &target, &served);
	if (status)
		return status;
	text = ctl_need(malloc(LISTING_MAX + 1));
	ask.req.fresh = fresh;
	ask.req.data = (uint8_t *)text;
	ask.req.len = LISTING_MAX;
	if (target_ask_one(&target, &ask)) {
		status = ctl_fail("%s: %s%s", path,
		                  ask.answer.err == -ENOENT ? "no such directory"
		                                            : target_error(&target, ask.answer.err),
		                  open_asked(ctl, &target, &served));
	} else {
		text[ask.answer.len] = '\0';
		print_entries(ctl, text, fresh ? "/uncached" : "");
	}
	target_close(&target);
	free(text);
	return status;
}

/* --- Values ---------------------------------------------------------------------------------- */

#define TEXT_MAX 65536

static char text[TEXT_MAX + 1];

static void read_print_json(struct json *json, const char *path, const struct bus_answer *answer,
                            size_t len)
{
	char words[ERROR_WORDS];

	json_object(json, NULL);
	json_string(json, "path", path);
	text[len] = '\0';
	if (answer->err)
		json_null(json, "value");
	else if (json_is_number(text, len))
		json_number(json, "value", text);
	else
		json_text(json, text, len);
	if (answer->err)
		json_string(json, "error", error_answer_text(answer->err, answer->number, words));
	json_bool(json, "simulated", answer->detail & BUS_DETAIL_SIMULATED);
	json_bool(json, "cached", answer->detail & BUS_DETAIL_CACHED);
	json_object_end(json);
}

static int read_path(const struct ctl *ctl, struct json *json, struct target *target,
                     const struct served *served, const char *given)
{
	char path[256];
	bool fresh;
	struct ask ask = {.req = {.op = BUS_READ,
	                          .prio = BUS_GUEST,
	                          .path = path,
	                          .data = (uint8_t *)text,
	                          .len = TEXT_MAX}};
	char words[ERROR_WORDS];
	size_t len = 0;
	int err;

	if (!target_path(given, path, &fresh))
		return ctl_fail("%s: the path is longer than %d bytes", given, 255);
	ask.req.fresh = fresh;
	err = target_ask_one(target, &ask);
	if (!err)
		len = target_unpad(text, ask.answer.len);
	if (ctl->json)
		read_print_json(json, given, &ask.answer, len);
	else if (!err)
		ctl_value(text, len);
	if (!err)
		return CTL_DONE;
	/* keep the order of stderr and stdout where both go to one place */
	if (!ctl->json)
		fflush(stdout);
	return ctl_fail("%s: %s%s", given, error_answer_words(err, ask.answer.number, words),
	                open_asked(ctl, target, served));
}

int verb_read(struct ctl *ctl, int argc, char **argv)
{
	int64_t timeout_ns = OPEN_TIMEOUT_NS;
	struct target target;
	struct served served;
	struct json json;
	int status;

	target_option(ctl, argc, argv, "", &timeout_ns);
	if (optind == argc)
		return ctl_usage(ctl, "read what?");
	status = open_target(ctl, timeout_ns, &target, &served);
	if (status)
		return status;
	json_list(&json, stdout, ctl->json);
	for (int i = optind; i < argc; i++)
		if (read_path(ctl, &json, &target, &served, argv[i]))
			status = CTL_FAILED;
	json_list_end(&json);
	target_close(&target);
	return status;
}

/* owsd refused a write: name the output that sets the same bits. False: for another reason. */
static bool name_output(const struct ctl *ctl, const struct served *served, const char *path)
{
	struct shared_bits bits, other;
	struct ows_info info;
	bool found = false;
	struct ows *h;

	if (ctl->target || !served->target[0] || !shared_bits(path, &bits) ||
	    ows_open(ctl->instance, OWS_READ, &h) != 0)
		return false;
	for (int i = 0; !found && ows_info(h, i, &info) == 0; i++)
		found = info.output && shared_bits(info.path, &other) &&
		        shared_overlap(&bits, &other);
	if (found)
		ctl_fail("%s: the output %s sets the same bits: owsctl set %s VALUE", path,
		         info.name, info.name);
	ows_close(h);
	return found;
}

int verb_write(struct ctl *ctl, int argc, char **argv)
{
	int64_t timeout_ns = OPEN_TIMEOUT_NS;
	struct target target;
	struct served served;
	char path[256], words[ERROR_WORDS];
	bool fresh;
	struct ask ask = {.req = {.op = BUS_WRITE, .prio = BUS_OUTPUT, .path = path}};
	int status;

	/* A value may begin with "-". */
	target_option(ctl, argc, argv, "+", &timeout_ns);
	if (argc - optind != 2)
		return ctl_usage(ctl, "expected a path and a value");
	if (!target_path(argv[optind], path, &fresh))
		return ctl_usage(ctl, "the path is longer than %d bytes", 255);
	status = open_target(ctl, timeout_ns, &target, &served);
	if (status)
		return status;
	ask.req.fresh = fresh;
	ask.req.data = (uint8_t *)argv[optind + 1];
	ask.req.len = (uint32_t)strlen(argv[optind + 1]);
	if (target_ask_one(&target, &ask))
		status = ask.answer.err == -EPERM && name_output(ctl, &served, path)
		                 ? CTL_FAILED
		                 : ctl_fail("%s: %s%s", argv[optind],
		                            error_words(ask.answer.err, words),
		                            open_asked(ctl, &target, &served));
	target_close(&target);
	return status;
}
