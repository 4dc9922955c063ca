/* SPDX-License-Identifier: MIT */
/*
 * The walk of a new client through a server (tests/bench/walk.h), in the guest; times are wall
 * seconds. The rows of the rig count what the wire did between two calls.
 *
 *   owwalk sim KHZ             a scenario with one of each part
 *   owwalk PORT dir            the devices, one a line
 *   owwalk PORT scan           the same by a new search of the wire
 *   owwalk PORT list           the devices on standard input: their properties, one a line
 *   owwalk PORT read           the paths on standard input: "PATH RET SECONDS"; it ends with the
 *                              one that ends the server, which is "PATH -1000 SECONDS"
 *
 * dir, scan, list and read say on the standard error what they did: "COUNT SECONDS".
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/bench/walk.h"

static struct walk walk;
static char names[16384];

static int scan(bool fresh)
{
	int n = walk_scan(&walk, fresh, names, sizeof(names));
	char *rest, *name;

	for (name = strtok_r(names, ",", &rest); name; name = strtok_r(NULL, ",", &rest))
		puts(name);
	fprintf(stderr, "%d %.3f\n", n, (double)walk.scan_ns / 1e9);
	return n < 0;
}

static int list(void)
{
	char line[64];
	size_t len = 0;

	while (fgets(line, sizeof(line), stdin) && len < sizeof(names) - sizeof(line)) {
		line[strcspn(line, "\n")] = '\0';
		len += (size_t)snprintf(names + len, sizeof(names) - len, "%s%s", len ? "," : "",
		                        line);
	}
	walk_list(&walk, names);
	for (unsigned i = 0; i < walk.properties; i++)
		puts(walk.property[i].path);
	fprintf(stderr, "%u %.3f\n", walk.directories, (double)walk.list_ns / 1e9);
	if (walk.unlisted)
		fprintf(stderr, "# %u not listed: %s\n", walk.unlisted, walk.why);
	return 0;
}

static int read_all(void)
{
	char line[WALK_PATH];

	while (walk.properties < WALK_MOST && fgets(line, sizeof(line), stdin)) {
		line[strcspn(line, "\n")] = '\0';
		memcpy(walk.property[walk.properties++].path, line, sizeof(line));
	}
	walk_read(&walk);
	for (unsigned i = 0; i < walk.properties; i++)
		printf("%s %d %.6f\n", walk.property[i].path, walk.property[i].ret,
		       (double)walk.property[i].ns / 1e9);
	fprintf(stderr, "%u %.3f\n", walk.properties, (double)walk.read_ns / 1e9);
	return 0;
}

int main(int argc, char **argv)
{
	const char *verb = argc == 3 ? argv[2] : "";
	int status = 2;

	if (argc == 3 && strcmp(argv[1], "sim") == 0)
		return walk_scenario(stdout, (unsigned)strtoul(verb, NULL, 10)) == 0;
	walk_init(&walk, argc == 3 ? (uint16_t)strtoul(argv[1], NULL, 10) : 0);
	if (strcmp(verb, "dir") == 0 || strcmp(verb, "scan") == 0)
		status = scan(strcmp(verb, "scan") == 0);
	else if (strcmp(verb, "list") == 0)
		status = list();
	else if (strcmp(verb, "read") == 0)
		status = read_all();
	else
		fputs("usage: owwalk sim KHZ | owwalk PORT dir|scan|list|read\n", stderr);
	walk_end(&walk);
	return status;
}
