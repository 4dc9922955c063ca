/* SPDX-License-Identifier: MIT */
/*
 * What owsd costs while it works: 100 thermometers of a genuine owserver, Period 0.1, PerFactor 10;
 * beside it the server it asks. And what a chip family adds to the program: code and read-only
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

/* A field of /proc/PID/status. */
static double status_of(pid_t pid, const char *field)
{
	char path[64], line[256];
	double value = -1;
	FILE *f;

	snprintf(path, sizeof(path), "/proc/%d/status", (int)pid);
	f = fopen(path, "r");
	while (f && fgets(line, sizeof(line), f))
		if (strncmp(line, field, strlen(field)) == 0)
			value = atof(line + strlen(field) + 1);
	if (f)
		fclose(f);
	return value;
}

/* Time all threads ran, ns, exact where the kernel keeps it. */
static double ran_ns(pid_t pid)
{
	char path[512];
	double total = 0, ns;
	struct dirent *entry;
	DIR *folder;

	snprintf(path, sizeof(path), "/proc/%d/task", (int)pid);
	folder = opendir(path);
	while (folder && (entry = readdir(folder)) != NULL) {
		FILE *f;

		snprintf(path, sizeof(path), "/proc/%d/task/%s/schedstat", (int)pid, entry->d_name);
		f = entry->d_name[0] == '.' ? NULL : fopen(path, "r");
		if (f && fscanf(f, "%lf", &ns) == 1)
			total += ns;
		if (f)
			fclose(f);
	}
	if (folder)
		closedir(folder);
	return total > 0 ? total : (double)bench_cpu_ns(pid);
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

	for (size_t i = 0; i < n; i++) {
		all_shared += part[i].shared;
		all_own += part[i].own;
	}
	n = parts(folder, "family_*.o", part, 256);
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

static bool write_file(const char *file, const struct bench_peer *peer)
{
	FILE *f = fopen(file, "w");

	if (!f)
		return false;
	fprintf(f, "OwsDrv {\n  TargetName \"127.0.0.1:%d\"\n  Period 0.1\n", peer->port);
	for (unsigned i = 0; i < peer->devices; i++)
		fprintf(f,
		        "  Item {\n    Name \"t%u\"\n    Path \"%s\"\n    Type double\n    IO input\n"
		        "    PerFactor 10\n  }\n",
		        i, peer->paths[i]);
	fputs("}\n", f);
	return fclose(f) == 0;
}

int main(int argc, char **argv)
{
	char program[512], folder[512], file[128], instance[32];
	const char *slash = strrchr(argv[0], '/');
	struct bench_peer peer;
	double own, its;
	pid_t pid;

	(void)argc;
	bench_place();
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
	if (!write_file(file, &peer))
		return 1;
	pid = fork();
	if (pid == 0) {
		prctl(PR_SET_PDEATHSIG, SIGKILL);
		execl(program, program, "-c", file, "-n", instance, (char *)NULL);
		_exit(127);
	}
	sleep(3);
	own = ran_ns(pid);
	its = ran_ns(peer.pid);
	sleep(SECONDS_N);
	own = ran_ns(pid) - own;
	its = ran_ns(peer.pid) - its;
	bench_line("rss", status_of(pid, "VmRSS:"), "KiB");
	bench_line("rss.anonymous", status_of(pid, "RssAnon:"), "KiB");
	bench_line("rss.shared_memory", status_of(pid, "RssShmem:"), "KiB");
	bench_line("rss.owserver", status_of(peer.pid, "VmRSS:"), "KiB");
	bench_line("threads", status_of(pid, "Threads:"), "threads");
	bench_line("cpu_idle", own / SECONDS_N / 1e9 * 100, "%");
	bench_line("cpu_idle.owserver", its / SECONDS_N / 1e9 * 100, "%");
	kill(pid, SIGTERM);
	waitpid(pid, NULL, 0);
	unlink(file);
	bench_peer_end(&peer);
	return 0;
}
