/* SPDX-License-Identifier: MIT */
/* The Web block: where owsd-web serves its page, for whom, and what the page may do. */
#include <string.h>

#include "src/config/build.h"
#include "src/config/serve.h"
#include "src/config/web.h"
#include "src/shm/owner.h"

#define FILES_MAX 255
#define HOST_CHARS "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.-_, \t"

/* The text, kept; NULL: it is not given, or empty. */
static const char *keep(struct build *build, const struct option_value *value)
{
	if (!value->given || !*value->text)
		return NULL;
	return build_keep(build, value->text, strlen(value->text));
}

static void take_proxy(struct build *build, const struct option_value *value,
                       struct config_web *web)
{
	const char *why;
	uid_t uid;

	web->proxy = keep(build, value);
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
	static const struct rio_node none;
	struct config_web *web = &build->box->config.web;
	struct option_value values[OPTION_COUNT_ALL];
	const struct option_value *listen = &values[OPT_WEB_LISTEN],
				  *files = &values[OPT_WEB_FILES];
	const struct option_value *hosts = &values[OPT_WEB_HOSTS];

	options_read(block ? block : &none, PLACE_WEB, values, build->report);
	web->given = block != NULL;
	web->listen = keep(build, listen);
	if (web->listen)
		serve_addresses(build, web->listen, listen->node->value_at, web->addresses,
		                &web->address_count);
	web->hosts = keep(build, hosts);
	if (web->hosts && web->hosts[strspn(web->hosts, HOST_CHARS)])
		report_error(build->report, hosts->node->value_at,
		             "Hosts \"%s\": expected names with commas between them, no ports",
		             web->hosts);
	web->write = values[OPT_WEB_WRITE].number != 0;
	web->configure = values[OPT_WEB_CONFIGURE].number != 0;
	take_proxy(build, &values[OPT_WEB_PROXY], web);
	web->files = keep(build, files);
	if (web->files && (web->files[0] != '/' || strlen(web->files) > FILES_MAX))
		report_error(build->report, files->node->value_at,
		             "Files \"%s\": expected a path from the root, at most %d bytes",
		             web->files, FILES_MAX);
}
