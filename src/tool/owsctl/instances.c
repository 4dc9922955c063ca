/* SPDX-License-Identifier: MIT */
/*
 * owsctl instances and remove: lists the owsds that run here or have run, and removes the files of
 * those that ended.
 */
#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "src/faces/show/json.h"
#include "src/faces/show/when.h"
#include "src/memory/shm/remains.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/running.h"
#include "src/tool/owsctl/table.h"
#include "src/tool/owsctl/verbs.h"

/* clang-format off */
static const struct table_column columns[] = {
	{"NAME"}, {"STATE"}, {"PID", .right = true}, {"SINCE", .right = true},
	{"SIGNALS", .right = true}, {"TARGETS"}, {"PLACE"}, {"CONFIG"},
};
#define PLACE_COLUMN 6
/* clang-format on */

static void instances_add_row(struct table *table, const struct instance_info *info,
                              const struct when *now)
{
	char pid[16] = "-", signals[16] = "-", span[WHEN_TEXT] = "-";

	if (info->pid)
		snprintf(pid, sizeof(pid), "%d", info->pid);
	if (info->signals >= 0)
		snprintf(signals, sizeof(signals), "%d", info->signals);
	if (info->since_ns)
		when_span(now->boot - info->since_ns, span);
	table_add(table,
	          (const char *const[]){info->name, instance_state_text(info->state), pid, span,
	                                signals, info->targets[0] ? info->targets : "-", info->dir,
	                                info->why         ? info->why
	                                : info->config[0] ? info->config
	                                                  : "-"});
}

static void add_json(struct json *json, const struct instance_info *info, const struct when *now)
{
	char text[WHEN_TEXT];

	json_object(json, NULL);
	json_string(json, "instance", info->name);
	json_string(json, "place", info->dir);
	json_string(json, "state", instance_state_text(info->state));
	json_known(json, "pid", info->pid ? info->pid : -1);
	json_string(json, "since", info->since_ns ? when_iso(now, info->since_ns, text) : NULL);
	json_known(json, "signals", info->signals);
	json_string(json, "targets", info->targets[0] ? info->targets : NULL);
	json_string(json, "config", info->config[0] ? info->config : NULL);
	json_string(json, "error", info->why);
	json_object_end(json);
}

/* The directories that are there, each with its instances. */
struct found {
	struct shm_dir dir[DIRS];
	struct remains remains[DIRS];
	unsigned count;
};

static void close_dirs(struct found *found)
{
	for (unsigned i = 0; i < found->count; i++) {
		remains_free(&found->remains[i]);
		dir_close(&found->dir[i]);
	}
}

/* CTL_DONE, or CTL_FAILED after printing why. One directory that is refused hides no other. */
static int open_dirs(struct found *found)
{
	char paths[DIRS][DIR_PATH], fault[DIR_FAULT];
	int count = dir_list(paths), status = CTL_DONE;

	*found = (struct found){0};
	if (count < 0)
		return ctl_fail("%s", dir_fault(&found->dir[0], count, fault));
	for (int i = 0; i < count; i++) {
		struct shm_dir *dir = &found->dir[found->count];
		int err = dir_open(paths[i], dir);

		if (err == -ENOENT)
			continue;
		if (err) {
			status = ctl_fail("%s", dir_fault(dir, err, fault));
			continue;
		}
		err = remains_list(dir, &found->remains[found->count++]);
		if (err)
			status = ctl_fail("%s: %s", dir->path, strerror(-err));
	}
	return status;
}

static void instances_show(const struct found *found, bool as_json)
{
	struct instance_info info;
	struct when now = when_now();
	struct table table;
	struct json json;

	table_init(&table, columns, sizeof(columns) / sizeof(columns[0]));
	table.absent[PLACE_COLUMN] = !found->remains[0].count || !found->remains[1].count;
	json_list(&json, stdout, as_json);
	for (unsigned k = 0; k < found->count; k++)
		for (unsigned i = 0; i < found->remains[k].count; i++) {
			instance_look(&found->dir[k], found->remains[k].name[i], now.boot, &info);
			if (as_json)
				add_json(&json, &info, &now);
			else
				instances_add_row(&table, &info, &now);
		}
	json_list_end(&json);
	if (table.rows)
		table_print(&table, true);
	table_free(&table);
}

int verb_instances(struct ctl *ctl, int argc, char **argv)
{
	struct found found;
	int status;

	ctl_option(ctl, argc, argv, "");
	if (optind < argc)
		return ctl_usage(ctl, "instances takes no operands");
	status = open_dirs(&found);
	if (status == CTL_DONE && !found.remains[0].count && !found.remains[1].count)
		ctl_fail("no owsd has run here");
	instances_show(&found, ctl->json);
	close_dirs(&found);
	return status;
}

/* Remove the instance from the first directory that has files of it. */
static int remove_one(const struct found *found, const char *name, unsigned *files, int *pid)
{
	int err = -ENOENT;

	if (!segment_name_ok(name))
		return -EINVAL;
	for (unsigned i = 0; i < found->count && err == -ENOENT; i++) {
		pid_t holder = 0;

		if (instance_runs(&found->dir[i], name, pid))
			return -EBUSY;
		err = remains_remove(&found->dir[i], name, &holder, files);
		if (holder)
			*pid = (int)holder;
	}
	return err;
}

static int instances_refuse(const char *name, int err, int pid)
{
	switch (-err) {
	case EBUSY:
		if (pid)
			return ctl_fail("owsd %s is running (process %d): it is not removed", name,
			                pid);
		return ctl_fail("owsd %s is running: it is not removed", name);
	case ENOENT:
		return ctl_fail("nothing is there of an owsd of the name %s", name);
	case EACCES:
	case EPERM:
		return ctl_fail("no right to remove what is left of %s: its owner and root have it",
		                name);
	case ENOTEMPTY:
		return ctl_fail(
			"not all that is left of %s is removed: a directory under one of its names "
			"has files",
			name);
	case EINVAL:
		return ctl_fail("%s cannot be the name of an instance", ctl_word(name));
	}
	return ctl_fail("cannot remove what is left of %s: %s", name, strerror(-err));
}

int verb_remove(struct ctl *ctl, int argc, char **argv)
{
	struct found found;
	struct json json;
	int status;

	ctl_option(ctl, argc, argv, "");
	if (optind == argc)
		return ctl_usage(ctl, "remove which instance? owsctl instances lists them");
	status = open_dirs(&found);
	if (status && !found.count)
		return status;
	json_list(&json, stdout, ctl->json);
	for (int i = optind; i < argc; i++) {
		const char *name = argv[i];
		unsigned files = 0;
		int pid = 0, err = remove_one(&found, name, &files, &pid);

		if (err)
			status = instances_refuse(name, err, pid);
		else if (!ctl->json)
			printf("removed %s: %u file%s\n", name, files, files == 1 ? "" : "s");
		if (ctl->json) {
			json_object(&json, NULL);
			json_string(&json, "instance", name);
			json_bool(&json, "removed", !err);
			json_uint(&json, "files", files);
			json_object_end(&json);
		}
	}
	json_list_end(&json);
	close_dirs(&found);
	return status;
}
