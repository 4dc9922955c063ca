/* SPDX-License-Identifier: MIT */
/* The Web block: where owsd-web serves its page, for whom, and what the page may do. */
#include <string.h>

#include "src/config/read/options.h"
#include "src/config/read/others.h"
#include "src/config/read/serve.h"
#include "src/config/read/web.h"
#include "src/memory/shm/owner.h"

static void take_proxy(struct build *build, const struct option_value *value,
                       struct config_web *web)
{
	const char *why;
	uid_t uid;

	if (!web->proxy)
		return;
	if (strpbrk(web->proxy, ".:")) {
		if (strchr(web->proxy, '/') ||
		    listen_peers_parse(web->proxy, strlen(web->proxy), &web->proxy_at, &why))
			report_error(
				build->report, value->node->value_at,
				"Proxy \"%s\": expected a user of this machine, or one address",
				web->proxy);
		return;
	}
	web->has_proxy = owner_user(web->proxy, &uid);
	if (web->has_proxy)
		web->proxy_uid = uid;
	else
		report_warning(build->report, value->node->value_at,
		               "Proxy: there is no user %s here", web->proxy);
}

/* Is there one of that name before this part of the list? */
static bool is_among(const char *text, const char *part, const char *name)
{
	struct other_place before;
	const char *why;

	while (other_next(&text, &before, &why) && text && text <= part)
		if (!strcmp(before.name, name))
			return true;
	return false;
}

static void check_others(struct build *build, const char *all, struct rio_position position)
{
	const char *text = all, *part, *why;
	struct other_place place;
	unsigned count = 0;
	size_t len;

	while (build_part(&text, ",", &part, &len)) {
		why = other_parse(part, len, &place);
		if (!why && is_among(all, part, place.name))
			why = "a machine before it has that name";
		if (!why && count++ == OTHERS_MAX)
			why = "is one machine too many, there may be 32";
		if (why)
			report_error(build->report, position, "Others \"%.*s\": %s", (int)len, part,
			             why);
	}
}

void web_derive(struct build *build, const struct option_value *values)
{
	struct config_web *web = &build->box->config.web;

	if (web->listen)
		serve_addresses(build, web->listen, values[OPT_WEB_LISTEN].node->value_at,
		                web->addresses, &web->address_count);
	if (web->others)
		check_others(build, web->others, values[OPT_WEB_OTHERS].node->value_at);
	take_proxy(build, &values[OPT_WEB_PROXY], web);
}
