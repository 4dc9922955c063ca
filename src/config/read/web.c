/* SPDX-License-Identifier: MIT */
/* The Web block: where owsd-web serves its page, for whom, and what the page may do. */
#include <string.h>

#include "src/config/read/build.h"
#include "src/config/read/serve.h"
#include "src/config/read/web.h"
#include "src/memory/shm/owner.h"

#define HOST_CHARS "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.-_, \t"

static const char *check_hosts(const char *hosts)
{
	return hosts[strspn(hosts, HOST_CHARS)]
	               ? "expected names with commas between them, no ports"
	               : NULL;
}

static void take_proxy(struct build *build, const struct option_value *values,
                       struct config_web *web)
{
	const struct option_value *value = &values[OPT_WEB_PROXY];
	const char *why;
	uid_t uid;

	web->proxy = text_key(build, values, OPT_WEB_PROXY, NULL);
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

void web_build(struct build *build, const struct rio_node *block)
{
	struct config_web *web = &build->box->config.web;
	struct option_value values[OPTION_COUNT_ALL];

	options_read(block, PLACE_WEB, values, build->report);
	web->given = block != NULL;
	web->listen = text_key(build, values, OPT_WEB_LISTEN, NULL);
	if (web->listen)
		serve_addresses(build, web->listen, values[OPT_WEB_LISTEN].node->value_at,
		                web->addresses, &web->address_count);
	web->hosts = text_key(build, values, OPT_WEB_HOSTS, check_hosts);
	web->write = values[OPT_WEB_WRITE].number != 0;
	web->configure = values[OPT_WEB_CONFIGURE].number != 0;
	take_proxy(build, values, web);
	web->files = text_key(build, values, OPT_WEB_FILES, text_is_path);
}
