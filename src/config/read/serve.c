/* SPDX-License-Identifier: MIT */
/* The keys Listen... of the driver block. */
#include <errno.h>
#include <string.h>

#include "src/config/read/build.h"
#include "src/config/read/options.h"
#include "src/config/read/serve.h"

struct addresses {
	struct listen_address *all; /* LISTEN_MAX */
	unsigned *count;
};

static void add_address(struct build *build, const struct addresses *to,
                        const struct listen_address *address, const char *part, size_t len,
                        struct place place)
{
	for (unsigned i = 0; i < *to->count; i++)
		if (address->port && listen_same(&to->all[i], address)) {
			report_error(build->report, place, "Listen \"%.*s\": is given twice",
			             (int)len, part);
			return;
		}
	if (*to->count == LISTEN_MAX) {
		report_error(build->report, place, "Listen: more than %d addresses", LISTEN_MAX);
		return;
	}
	to->all[(*to->count)++] = *address;
}

void serve_addresses(struct build *build, const char *text, struct place place,
                     struct listen_address *all, unsigned *count)
{
	const struct addresses to = {.all = all, .count = count};
	struct listen_address addresses[2];
	const char *part, *why = "";
	size_t len;

	while (build_part(&text, ",", &part, &len)) {
		int n = listen_parse(part, len, addresses, &why);

		if (n < 0)
			report_error(build->report, place, "Listen \"%.*s\": %s", (int)len, part,
			             why);
		for (int i = 0; i < n; i++)
			add_address(build, &to, &addresses[i], part, len, place);
	}
}

static void add_listens(struct build *build, const char *text, struct place place)
{
	struct config_serve *serve = &build->box->config.serve;

	serve_addresses(build, text, place, serve->addresses, &serve->address_count);
}

static void add_peers(struct build *build, const struct option_value *allow)
{
	struct config_serve *serve = &build->box->config.serve;
	const char *text = allow->text, *part, *why = "";
	size_t len;

	while (build_part(&text, ",", &part, &len)) {
		if (serve->peer_count == LISTEN_PEERS_MAX) {
			report_error(build->report, allow->node->value_at,
			             "ListenAllow: more than %d entries", LISTEN_PEERS_MAX);
			return;
		}
		if (listen_peers_parse(part, len, &serve->peers[serve->peer_count], &why))
			report_error(build->report, allow->node->value_at,
			             "ListenAllow \"%.*s\": %s", (int)len, part, why);
		else
			serve->peer_count++;
	}
}

void serve_build(struct build *build, const struct option_value *values)
{
	if (values[OPT_LISTEN].given && *values[OPT_LISTEN].text)
		add_listens(build, values[OPT_LISTEN].text, values[OPT_LISTEN].node->value_at);
	if (values[OPT_LISTEN_ALLOW].given)
		add_peers(build, &values[OPT_LISTEN_ALLOW]);
}

int serve_listens(struct build *build, const char *const *texts, unsigned count)
{
	unsigned before = build->report->errors;

	build->box->config.serve.address_count = 0;
	for (unsigned i = 0; i < count; i++)
		add_listens(build, texts[i], (struct place){0});
	return build->report->errors == before ? 0 : -EINVAL;
}
