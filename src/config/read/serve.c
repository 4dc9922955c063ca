/* SPDX-License-Identifier: MIT */
/* The keys Listen... of the driver block. */
#include <errno.h>

#include "src/config/read/build.h"
#include "src/config/read/options.h"
#include "src/config/read/serve.h"

/* Does one of them stand there already? With port 0 the kernel chooses, each time anew. */
static bool has_address(const struct listen_address *all, unsigned count,
                        const struct listen_address *address)
{
	while (count && address->port && !listen_same(&all[count - 1], address))
		count--;
	return count && address->port;
}

void serve_addresses(struct build *build, const char *text, struct rio_position position,
                     struct listen_address *all, unsigned *count)
{
	struct listen_address addresses[2];
	const char *part, *why = "";
	size_t len;

	while (build_part(&text, ",", &part, &len)) {
		int n = listen_parse(part, len, addresses, &why);

		for (int i = 0; i < n; i++)
			if (has_address(all, *count, &addresses[i])) {
				why = "is given twice";
				n = -EINVAL;
			} else if (*count == LISTEN_MAX) {
				why = "is one address too many";
				n = -EINVAL;
			} else {
				all[(*count)++] = addresses[i];
			}
		if (n < 0)
			report_error(build->report, position, "Listen \"%.*s\": %s", (int)len, part,
			             why);
	}
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
	struct config_serve *serve = &build->box->config.serve;
	const struct option_value *listen = &values[OPT_LISTEN];

	if (listen->given && *listen->text)
		serve_addresses(build, listen->text, listen->node->value_at, serve->addresses,
		                &serve->address_count);
	if (values[OPT_LISTEN_ALLOW].given)
		add_peers(build, &values[OPT_LISTEN_ALLOW]);
}

int serve_listens(struct build *build, const char *const *texts, unsigned count)
{
	struct config_serve *serve = &build->box->config.serve;
	unsigned before = build->report->errors;

	serve->address_count = 0;
	for (unsigned i = 0; i < count; i++)
		serve_addresses(build, texts[i], (struct rio_position){0}, serve->addresses,
		                &serve->address_count);
	return build->report->errors == before ? 0 : -EINVAL;
}
