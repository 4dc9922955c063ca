/* SPDX-License-Identifier: MIT */
/* owsctl dir: the entries of a directory of a target. */
#include <errno.h>
#include <getopt.h>
#include <stdlib.h>
#include <string.h>

#include "src/faces/show/json.h"
#include "src/faces/show/text.h"
#include "src/tool/owsctl/open.h"
#include "src/tool/owsctl/verbs.h"

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
		                                            : error_text(ask.answer.err),
		                  open_asked(ctl, &target, &served));
	} else {
		text[ask.answer.len] = '\0';
		print_entries(ctl, text, fresh ? "/uncached" : "");
	}
	target_close(&target);
	free(text);
	return status;
}
