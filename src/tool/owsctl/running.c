/* SPDX-License-Identifier: MIT */
/* What is to be seen of an instance: by its lock, its image and its process. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "src/config/read/load.h"
#include "src/memory/libows/open.h"
#include "src/memory/shm/lock.h"
#include "src/memory/shm/remains.h"
#include "src/tool/owsctl/running.h"

enum instance_state instance_state_of(bool has_image, uint32_t state, bool alive, int lock,
                                      bool process)
{
	bool held = lock < 0 ? process : lock > 0;

	if (!has_image)
		return held ? INSTANCE_HIDDEN : INSTANCE_LEFT;
	if (state == 3)
		return INSTANCE_STOPPED;
	/* a stopped heart shows after two seconds, a released lock at once */
	if (alive && lock != 0)
		return INSTANCE_RUNNING;
	return held ? INSTANCE_HANGS : INSTANCE_KILLED;
}

/* Does the instance's process exist? Then owsctl removes none of its files. */
static bool is_up(enum instance_state state)
{
	return state == INSTANCE_RUNNING || state == INSTANCE_HANGS;
}

const char *instance_state_text(enum instance_state state)
{
	static const char *const texts[] = {
		[INSTANCE_RUNNING] = "running", [INSTANCE_HANGS] = "hangs",
		[INSTANCE_STOPPED] = "stopped", [INSTANCE_KILLED] = "killed",
		[INSTANCE_LEFT] = "remains",    [INSTANCE_HIDDEN] = "hidden",
	};

	return texts[state];
}

/*
 * The argument of -c in a word: "-cFILE" or "--config=FILE"; "" when the next word is the argument.
 */
static const char *option_in(const char *word)
{
	if (!strncmp(word, "--config", 8) && (!word[8] || word[8] == '='))
		return word[8] ? word + 9 : "";
	return !strncmp(word, "-c", 2) ? word + 2 : NULL;
}

const char *instance_config_of(const char *line, size_t len)
{
	const char *end = line + len, *found = NULL;

	if (!len || line[len - 1])
		return NULL;
	/* the last option counts, as for getopt */
	for (const char *word = line; word < end; word += strlen(word) + 1) {
		const char *value = word == line ? NULL : option_in(word);

		if (!value)
			continue;
		if (!*value) {
			word += strlen(word) + 1;
			if (word >= end)
				break;
			value = word;
		}
		found = value;
	}
	return found;
}

/* --- What is to be seen of it ---------------------------------------------------------------- */

static size_t read_process(int pid, const char *what, char *text, size_t size)
{
	char path[48];
	FILE *file;
	size_t len = 0;

	snprintf(path, sizeof(path), "/proc/%d/%s", pid, what);
	file = pid > 0 ? fopen(path, "re") : NULL;
	if (file) {
		len = fread(text, 1, size - 1, file);
		fclose(file);
	}
	text[len] = '\0';
	return len;
}

static bool is_owsd(int pid)
{
	static const char comm[] = " (owsd) ";
	char stat[128];
	const char *state;

	read_process(pid, "stat", stat, sizeof(stat));
	state = strchr(stat, ' ');
	return state && !strncmp(state, comm, strlen(comm)) && !strchr("ZX", state[strlen(comm)]);
}

/*
 * The path of the configuration: absolute where the process's directory may be read, else as given.
 */
static void find_config(struct instance_info *info)
{
	char line[4096], path[48], folder[INSTANCE_FIELD];
	size_t given = read_process(info->pid, "cmdline", line, sizeof(line));
	const char *config = instance_config_of(line, given);
	ssize_t len = -1;

	if (!config)
		return;
	snprintf(path, sizeof(path), "/proc/%d/cwd", info->pid);
	if (*config != '/')
		len = readlink(path, folder, sizeof(folder) - 1);
	if (len > 0 && len + strlen(config) + 2 < sizeof(info->config))
		snprintf(info->config, sizeof(info->config), "%.*s/%s", (int)len, folder, config);
	else
		snprintf(info->config, sizeof(info->config), "%s", config);
}

static void find_targets(struct ows *h, struct instance_info *info)
{
	struct ows_target target;
	size_t used = 0;

	for (int i = 0; ows_target(h, i, &target) == 0 && used < sizeof(info->targets); i++)
		used += (size_t)snprintf(info->targets + used, sizeof(info->targets) - used, "%s%s",
		                         i ? ", " : "", target.name);
}

void instance_look(const struct shm_dir *dir, const char *name, int64_t now_ns,
                   struct instance_info *info)
{
	struct ows_daemon daemon = {0};
	struct ows *h;
	pid_t holder = 0;
	int err = open_in(dir->path, name, OWS_READ, "owsctl", &h);
	int lock = segment_lock_look(dir, name, &holder);

	*info = (struct instance_info){
		.name = name, .dir = dir->path, .pid = (int)holder, .signals = -1};
	if (err && err != -ENOENT) {
		info->state = INSTANCE_HIDDEN;
		info->why = err == -EACCES  ? "no right to see it: that is for group owsd"
		            : err == -EPERM ? "it belongs to another user, neither root nor owsd"
		                            : "of another version of owsd, or not of owsd";
		return;
	}
	if (!err) {
		ows_daemon(h, now_ns, &daemon);
		info->pid = daemon.pid;
		info->signals = ows_count(h);
		find_targets(h, info);
		info->since_ns = daemon.alive ? daemon.start_ns : now_ns - daemon.beat_age_ns;
		ows_close(h);
		/*
		 * another owsd holds the lock: a free lock does not show that this owsd has ended
		 */
		if (!lock && holder != daemon.pid)
			lock = -ESTALE;
	}
	info->state = instance_state_of(!err, daemon.state, daemon.alive, lock, is_owsd(info->pid));
	if (info->state == INSTANCE_HIDDEN)
		info->why = "it is starting, or its files were removed";
	if (is_up(info->state)) {
		find_config(info);
		if (lock < 0 && lock != -EACCES)
			info->why = "it runs without its lock: the file was removed or replaced";
	}
	if (info->state == INSTANCE_LEFT)
		info->pid = 0;
}

bool instance_runs(const struct shm_dir *dir, const char *name, int *pid)
{
	struct instance_info info;

	instance_look(dir, name, ows_now(), &info);
	*pid = info.pid;
	return is_up(info.state);
}

static bool is_same_file(const char *a, const char *b)
{
	struct stat x, y;

	return *a && !stat(a, &x) && !stat(b, &y) && x.st_dev == y.st_dev && x.st_ino == y.st_ino;
}

static void default_config(struct instance_info *info)
{
	if (!info->config[0])
		snprintf(info->config, sizeof(info->config), CONFIG_DIR "/%s.rio", info->name);
}

void instance_config(const char *name, char config[INSTANCE_FIELD])
{
	char paths[DIRS][DIR_PATH];
	int dirs = dir_list(paths);
	struct instance_info info = {.name = name};
	struct shm_dir dir;

	for (int i = 0; i < dirs && !info.config[0]; i++) {
		if (dir_open(paths[i], &dir) != 0)
			continue;
		instance_look(&dir, name, ows_now(), &info);
		dir_close(&dir);
	}
	default_config(&info);
	snprintf(config, INSTANCE_FIELD, "%s", info.config);
}

/* file NULL: whatever configuration they have. */
static unsigned running(const char *file, char *name, char *names, size_t size)
{
	char paths[DIRS][DIR_PATH];
	int dirs = dir_list(paths);
	unsigned count = 0;
	size_t used = 0;

	for (int i = 0; i < dirs; i++) {
		struct shm_dir dir;
		struct remains remains = {0};

		if (dir_open(paths[i], &dir) != 0)
			continue;
		if (remains_list(&dir, &remains) != 0)
			remains.count = 0;
		for (unsigned k = 0; k < remains.count; k++) {
			struct instance_info info;

			instance_look(&dir, remains.name[k], ows_now(), &info);
			default_config(&info);
			if (!is_up(info.state) || (file && !is_same_file(info.config, file)))
				continue;
			snprintf(name, SEGMENT_NAME_MAX + 1, "%s", remains.name[k]);
			if (used < size)
				used += (size_t)snprintf(names + used, size - used, "%s%s",
				                         count ? ", " : "", name);
			count++;
		}
		remains_free(&remains);
		dir_close(&dir);
	}
	return count;
}

unsigned instances_running(char *name, char *names, size_t size)
{
	return running(NULL, name, names, size);
}

bool instance_of_file(const char *file, char *name)
{
	return running(file, name, NULL, 0) > 0;
}
