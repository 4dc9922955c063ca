/* SPDX-License-Identifier: MIT */
/*
 * What owsd costs while it works: 100 thermometers of a genuine owserver, Period 0.1, PerFactor 10;
 * beside it the server it asks, and what the same requests cost over a bare socket. And what it
 * costs when it has no signals, and what a chip family adds to the program: code and read-only
 * tables, which all processes share, and tables with pointers, which the loader writes: each
 * process has its own of those, whether the family is on the wire or not.
 */
#include <dirent.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/bench/aid.h"

#define SIGNALS 100
#define SECONDS_N 10

/* A field of a file of /proc/PID: status, smaps_rollup. */
static double field_of(pid_t pid, const char *file, const char *field)
{
	char path[64], line[256];
	double value = -1;
	FILE *f;

	snprintf(path, sizeof(path), "/proc/%d/%s", (int)pid, file);
	f = fopen(path, "r");
	while (f && fgets(line, sizeof(line), f))
		if (strncmp(line, field, strlen(field)) == 0)
			value = atof(line + strlen(field) + 1);
	if (f)
		fclose(f);
	return value;
}

static double status_of(pid_t pid, const char *field)
{
	return field_of(pid, "status", field);
}

struct spent {
	double ns;    /* time all threads ran, exact where the kernel keeps it */
	double wakes; /* how often one of them slept */
};

static struct spent spent_of(pid_t pid)
{
	struct spent spent = {0};
	struct dirent *entry;
	char path[512];
	double ns;
	DIR *folder;

	snprintf(path, sizeof(path), "/proc/%d/task", (int)pid);
	folder = opendir(path);
	while (folder && (entry = readdir(folder)) != NULL) {
		FILE *f;

		if (entry->d_name[0] == '.')
			continue;
		spent.wakes += status_of(atoi(entry->d_name), "voluntary_ctxt_switches:");
		snprintf(path, sizeof(path), "/proc/%d/task/%s/schedstat", (int)pid, entry->d_name);
		f = fopen(path, "r");
		if (f && fscanf(f, "%lf", &ns) == 1)
			spent.ns += ns;
		if (f)
			fclose(f);
	}
	if (folder)
		closedir(folder);
	if (spent.ns == 0)
		spent.ns = (double)bench_cpu_ns(pid);
	return spent;
}

static double percent(double ns)
{
	return ns / SECONDS_N / 1e9 * 100;
}

static double text_size(const char *program)
{
	char command[600], line[256] = "";
	double text = -1;
	FILE *f;

	snprintf(command, sizeof(command), "size '%s' 2>/dev/null", program);
	f = popen(command, "r");
	if (f && fgets(line, sizeof(line), f) && fgets(line, sizeof(line), f))
		text = atof(line);
	if (f)
		pclose(f);
	return text;
}

struct part {
	double shared, own; /* bytes */
};

/* Of the objects in a folder, from what size says: text, data, bss, then the name. */
static size_t parts(const char *folder, const char *pattern, struct part *part, size_t most)
{
	char command[600], line[512];
	unsigned long text, data, bss;
	size_t n = 0;
	FILE *f;

	snprintf(command, sizeof(command), "size '%s'/%s 2>/dev/null", folder, pattern);
	f = popen(command, "r");
	while (f && n < most && fgets(line, sizeof(line), f))
		if (sscanf(line, "%lu %lu %lu", &text, &data, &bss) == 3)
			part[n++] = (struct part){(double)text, (double)(data + bss)};
	if (f)
		pclose(f);
	return n;
}

static void family_sizes(const char *folder)
{
	static struct part part[256];
	double shared[256], all_shared = 0, all_own = 0, own = 0;
	size_t n = parts(folder, "*.o", part, 256);

	n += parts(folder, "*/*.o", part + n, 256 - n);
	for (size_t i = 0; i < n; i++) {
		all_shared += part[i].shared;
		all_own += part[i].own;
	}
	n = parts(folder, "*/*.o", part, 256);
	if (!n) {
		bench_note("families' sizes left out: no objects of them, or no program size");
		return;
	}
	for (size_t i = 0; i < n; i++) {
		shared[i] = part[i].shared;
		own += part[i].own;
	}
	bench_line("family_text.files", (double)n, "files");
	bench_line("family_text.median", bench_percentile(shared, n, 50), "bytes");
	bench_line("family_text.largest", shared[n - 1], "bytes");
	bench_line("family_text.with_shared_parts", all_shared / 1024, "KiB");
	bench_line("family_own.mean", own / (double)n, "bytes");
	bench_line("family_own.with_shared_parts", all_own / 1024, "KiB");
}

static bool write_file(const char *file, const struct bench_peer *peer, unsigned signals)
{
	FILE *f = fopen(file, "w");

	if (!f)
		return false;
	fprintf(f, "OwsDrv {\n  TargetName \"127.0.0.1:%d\"\n  Period 0.1\n", peer->port);
	for (unsigned i = 0; i < signals; i++)
		fprintf(f,
		        "  Item {\n    Name \"t%u\"\n    Path \"%s\"\n    Type double\n    IO input\n"
		        "    PerFactor 10\n  }\n",
		        i, peer->paths[i]);
	fputs("}\n", f);
	return fclose(f) == 0;
}

static pid_t start_owsd(const char *program, const char *file, const char *instance, int cpu)
{
	pid_t pid = fork();

	if (pid == 0) {
		prctl(PR_SET_PDEATHSIG, SIGKILL);
		if (cpu >= 0)
			bench_pin(cpu);
		execl(program, program, "-c", file, "-n", instance, (char *)NULL);
		_exit(127);
	}
	sleep(3);
	return pid;
}

static void end_owsd(pid_t pid)
{
	kill(pid, SIGTERM);
	waitpid(pid, NULL, 0);
}

static void with_signals(const char *program, const char *file, const char *instance, pid_t server)
{
	pid_t pid = start_owsd(program, file, instance, -1);
	struct spent own = spent_of(pid), its = spent_of(server), after;

	sleep(SECONDS_N);
	after = spent_of(pid);
	bench_line("rss", status_of(pid, "VmRSS:"), "KiB");
	bench_line("rss.proportional", field_of(pid, "smaps_rollup", "Pss:"), "KiB");
	bench_line("rss.anonymous", status_of(pid, "RssAnon:"), "KiB");
	bench_line("rss.shared_memory", status_of(pid, "RssShmem:"), "KiB");
	bench_line("rss.owserver", status_of(server, "VmRSS:"), "KiB");
	bench_line("threads", status_of(pid, "Threads:"), "threads");
	bench_line("cpu_idle", percent(after.ns - own.ns), "%");
	bench_line("cpu_idle.owserver", percent(spent_of(server).ns - its.ns), "%");
	bench_line("wakes", (after.wakes - own.wakes) / SECONDS_N, "/s");
	end_owsd(pid);
}

/* Its threads wake each other without another processor, which may sleep deeply. */
static void on_one_cpu(const char *program, const char *file, const char *instance)
{
	pid_t pid = start_owsd(program, file, instance, 0);
	struct spent before = spent_of(pid);

	sleep(SECONDS_N);
	bench_line("cpu_idle.one_cpu", percent(spent_of(pid).ns - before.ns), "%");
	end_owsd(pid);
}

static void without_signals(const char *program, const char *file, const char *instance)
{
	pid_t pid = start_owsd(program, file, instance, -1);
	struct spent before = spent_of(pid), after;

	sleep(SECONDS_N);
	after = spent_of(pid);
	bench_line("cpu_idle.no_signals", percent(after.ns - before.ns), "%");
	bench_line("wakes.no_signals", (after.wakes - before.wakes) / SECONDS_N, "/s");
	end_owsd(pid);
}

/* The same requests, one after the other once a second, and nothing is done with the answers. */
static void bare_socket(const struct bench_peer *peer)
{
	int fd = bench_socket(peer->port);
	struct spent before = spent_of(getpid());
	char answer[64];

	for (unsigned s = 0; s < SECONDS_N; s++) {
		for (unsigned i = 0; i < peer->devices; i++)
			if (bench_read(fd, peer->paths[i], answer, sizeof(answer)) < 0) {
				bench_note("the bare socket was not answered");
				return;
			}
		sleep(1);
	}
	bench_line("cpu_idle.bare_socket", percent(spent_of(getpid()).ns - before.ns), "%");
	close(fd);
}

int main(int argc, char **argv)
{
	char program[512], folder[512], file[128], instance[32];
	const char *slash = strrchr(argv[0], '/');
	struct bench_peer peer;

	(void)argc;
	bench_dir();
	snprintf(program, sizeof(program), "%.*s/../owsd", slash ? (int)(slash - argv[0]) : 1,
	         slash ? argv[0] : ".");
	bench_line("text_size", text_size(program) / 1024, "KiB");
	snprintf(folder, sizeof(folder), "%.*s/../hal/chips", slash ? (int)(slash - argv[0]) : 1,
	         slash ? argv[0] : ".");
	family_sizes(folder);
	if (!bench_peer_start(&peer, SIGNALS, -1))
		return 0;
	snprintf(file, sizeof(file), "%s/bench.rio", peer.folder);
	snprintf(instance, sizeof(instance), "bench-%d", (int)getpid());
	if (!write_file(file, &peer, peer.devices))
		return 1;
	with_signals(program, file, instance, peer.pid);
	on_one_cpu(program, file, instance);
	if (!write_file(file, &peer, 0))
		return 1;
	without_signals(program, file, instance);
	bare_socket(&peer);
	unlink(file);
	bench_peer_end(&peer);
	return 0;
}
