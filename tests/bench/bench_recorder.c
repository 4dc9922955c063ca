/* SPDX-License-Identifier: MIT */
/*
 * What keeping readings costs a disk: the recorder's own writer, plain SQLite with the same rows of
 * values and a commit a second, w1retap, and rrdtool with the archives of collectd, all with the
 * same readings of thermometers each second, 15 of 100 of which are another value, and once 1.6 of
 * 100. w1retap is played: it reads a wire in rounds of two minutes, of which its driver of SQLite
 * puts all readings into its table readings and commits. Then what a question costs: a day of one
 * signal, and a month of it by hours, of a month of readings each two minutes.
 * A day in hurried time; of the slow ones a part of it, reckoned up, and of none the first half
 * minute. Bytes are those that an ext4 on a loop device writes to it; what nobody syncs is written
 * each half minute, as the kernel does, and its journal has the times of files in five seconds.
 * Needs root, for the loop device.
 *     bench_recorder [HOURS [DIRECTORY]]
 * HOURS: of a day no more than that. DIRECTORY: on a file system that nothing else writes, in place
 * of the loop device.
 */
#include <fcntl.h>
#include <sched.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "src/ground/signal/value.h"
#include "src/history/file/writer.h"
#include "tests/bench/aid.h"
#include "tests/bench/readings.h"

#define S INT64_C(1000000000)
#define DATE (20000 * 86400 * S)
#define RRD_DATE 1700000000
#define KERNEL 30 /* seconds after which it writes what is dirty */
#define JOURNAL 5 /* and ext4 what changed of its own data */

static char disk[DIR_PATH + 64];

static void want(bool good, const char *what)
{
	if (good)
		return;
	fprintf(stderr, "bench_recorder: %s failed\n", what);
	exit(1);
}

/* --- The disk --------------------------------------------------------------------------------- */

static double sectors_written(void)
{
	unsigned long long fields[7] = {0};
	char path[64];
	struct stat st;
	FILE *file;

	want(stat(disk, &st) == 0, disk);
	snprintf(path, sizeof(path), "/sys/dev/block/%u:%u/stat", major(st.st_dev),
	         minor(st.st_dev));
	file = fopen(path, "r");
	want(file && fscanf(file, "%llu %llu %llu %llu %llu %llu %llu", &fields[0], &fields[1],
	                    &fields[2], &fields[3], &fields[4], &fields[5], &fields[6]) == 7,
	     path);
	fclose(file);
	return (double)fields[6];
}

/* What was written when the kernel, or ext4, had nothing left to write. */
static double settled;

static void sync_disk(void)
{
	int fd = open(disk, O_RDONLY | O_DIRECTORY | O_CLOEXEC);

	want(fd >= 0 && syncfs(fd) == 0, "syncfs");
	close(fd);
	settled = sectors_written();
}

/*
 * Have ext4 write its journal, if anything else was written since. The folder's inode is in the
 * block of those of its files, which the journal has anyway.
 */
static void commit_journal(const char *folder)
{
	int fd;

	if (sectors_written() == settled)
		return;
	fd = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	want(fd >= 0 && futimens(fd, NULL) == 0 && fsync(fd) == 0, "fsync");
	close(fd);
	settled = sectors_written();
}

/* False: not here. The kernel has nothing of it to write later. It goes with our mounts. */
static bool make_disk(void)
{
	char command[4 * sizeof(disk)];
	const char *place = bench_dir()->path;

	snprintf(disk, sizeof(disk), "%s/disk", place);
	if (unshare(CLONE_NEWNS) || mount("none", "/", NULL, MS_REC | MS_PRIVATE, NULL) ||
	    mkdir(disk, 0700))
		return false;
	snprintf(command, sizeof(command),
	         "truncate -s 4G %s/image && mkfs.ext4 -q -F -E lazy_itable_init=0 %s/image"
	         " && mount -o loop %s/image %s",
	         place, place, place, disk);
	return system(command) == 0;
}

static double bytes_in(const char *folder)
{
	char command[2 * sizeof(disk)];
	double kb = 0;
	FILE *du;

	snprintf(command, sizeof(command), "du -sk --exclude=*-wal %s", folder);
	du = popen(command, "r");
	want(du && fscanf(du, "%lf", &kb) == 1, command);
	pclose(du);
	return kb * 1024;
}

/* --- Who keeps them --------------------------------------------------------------------------- */

struct keeper {
	const char *name;
	void (*begin)(unsigned count, const char *folder);
	void (*value)(unsigned i, int64_t second, double value);
	void (*second)(int64_t second);
	void (*end)(int64_t second);
	bool each;           /* it takes each reading, and not those alone that are other ones */
	const char *program; /* that does it; NULL: we */
};

static struct history_writer *writer;

static void owsd_begin(unsigned count, const char *folder)
{
	const struct history_options options = {
		.directory = folder, .boot = 1, .keep = {.days = 90, .minutes = 730}};
	struct history_signal *signals = calloc(count, sizeof(*signals));
	char(*names)[16] = calloc(count, sizeof(*names));

	want(signals && names, "memory");
	for (unsigned i = 0; i < count; i++) {
		snprintf(names[i], sizeof(names[i]), "t%u", i);
		signals[i] = (struct history_signal){names[i], "°C", OWS_DOUBLE, 0, 4};
	}
	want(!history_writer_open(&options, 0, DATE, true, &writer) &&
	             !history_writer_signals(writer, signals, count, 0),
	     "the writer");
	history_writer_begin(writer, 0);
	free(signals);
	free(names);
}

static void owsd_value(unsigned i, int64_t second, double value)
{
	history_writer_value(writer, i, second * S, OWS_Q_GOOD, value_of_double(value), NULL, 0);
}

static void owsd_second(int64_t second)
{
	want(history_writer_tick(writer, second * S) == 0, "a commit");
}

static void owsd_end(int64_t second)
{
	want(history_writer_close(writer, second * S) == 0, "the last commit");
}

static sqlite3 *db;
static sqlite3_stmt *insert;

static void plain_begin(unsigned count, const char *folder)
{
	char path[sizeof(disk) + 64];

	(void)count;
	snprintf(path, sizeof(path), "%s/plain.sqlite", folder);
	want(sqlite3_open(path, &db) == SQLITE_OK &&
	             !sqlite3_exec(db,
	                           "create table raw (id integer primary key, signal integer not"
	                           " null, value, quality integer not null)",
	                           NULL, NULL, NULL) &&
	             !sqlite3_prepare_v2(db, "insert into raw values (?, ?, ?, ?)", -1, &insert,
	                                 NULL) &&
	             !sqlite3_exec(db, "begin", NULL, NULL, NULL),
	     path);
}

static void plain_value(unsigned i, int64_t second, double value)
{
	sqlite3_bind_int64(insert, 1, (DATE / S + second) * 1000000 + i);
	sqlite3_bind_int64(insert, 2, i + 1);
	sqlite3_bind_double(insert, 3, value);
	sqlite3_bind_int(insert, 4, OWS_Q_GOOD);
	want(sqlite3_step(insert) == SQLITE_DONE && !sqlite3_reset(insert), "an insert");
}

static void plain_second(int64_t second)
{
	(void)second;
	want(!sqlite3_exec(db, "commit; begin", NULL, NULL, NULL), "a commit");
}

static void plain_end(int64_t second)
{
	(void)second;
	sqlite3_finalize(insert);
	sqlite3_exec(db, "commit", NULL, NULL, NULL);
	sqlite3_close(db);
}

#define ROUND 120 /* seconds: w1retap's without its option -t */

/* Its mksens.sql, and the statements of its libw1sqlite */
static void w1retap_begin(unsigned count, const char *folder)
{
	char path[sizeof(disk) + 64];

	(void)count;
	snprintf(path, sizeof(path), "%s/w1retap.sqlite", folder);
	want(sqlite3_open(path, &db) == SQLITE_OK &&
	             !sqlite3_exec(db,
	                           "create table readings (date integer, name text, value real);"
	                           "begin",
	                           NULL, NULL, NULL) &&
	             !sqlite3_prepare_v2(db, "insert into readings(date,name,value) values (?,?,?)",
	                                 -1, &insert, NULL),
	     path);
}

static void w1retap_value(unsigned i, int64_t second, double value)
{
	char name[16];

	if (second % ROUND)
		return;
	snprintf(name, sizeof(name), "t%u", i);
	sqlite3_bind_int64(insert, 1, DATE / S + second);
	sqlite3_bind_text(insert, 2, name, -1, SQLITE_TRANSIENT);
	sqlite3_bind_double(insert, 3, value);
	want(sqlite3_step(insert) == SQLITE_DONE && !sqlite3_reset(insert), "an insert");
}

static void w1retap_second(int64_t second)
{
	if (second % ROUND == 0)
		plain_second(second);
}

static FILE *rrd_to, *rrd_from;
static unsigned rrd_asked;

static void rrd_answers(void)
{
	char line[256];

	fflush(rrd_to);
	while (rrd_asked) {
		want(fgets(line, sizeof(line), rrd_from) && strncmp(line, "ERROR", 5) != 0,
		     "rrdtool");
		rrd_asked -= strncmp(line, "OK", 2) == 0;
	}
}

/* What collectd makes of an interval of a second: 1200 rows of an hour to a year, of three sorts */
static void rrd_begin(unsigned count, const char *folder)
{
	static const char *const sorts[] = {"AVERAGE", "MIN", "MAX"};
	static const int spans[] = {3, 72, 504, 2232, 26352};
	int to[2], from[2];

	want(pipe(to) == 0 && pipe(from) == 0, "a pipe");
	if (fork() == 0) {
		dup2(to[0], STDIN_FILENO);
		dup2(from[1], STDOUT_FILENO);
		close(to[1]);
		close(from[0]);
		want(chdir(folder) == 0, folder);
		execlp("rrdtool", "rrdtool", "-", NULL);
		_exit(1);
	}
	close(to[0]);
	close(from[1]);
	rrd_to = fdopen(to[1], "w");
	rrd_from = fdopen(from[0], "r");
	want(rrd_to && rrd_from, "a pipe");
	for (unsigned i = 0; i < count; i++) {
		fprintf(rrd_to, "create t%u.rrd --start %d --step 1 DS:value:GAUGE:2:U:U", i,
		        RRD_DATE);
		for (int k = 0; k < 15; k++)
			fprintf(rrd_to, " RRA:%s:0.1:%d:1200", sorts[k % 3], spans[k / 3]);
		fputc('\n', rrd_to);
		rrd_asked++;
		rrd_answers();
	}
}

static void rrd_value(unsigned i, int64_t second, double value)
{
	fprintf(rrd_to, "update t%u.rrd %lld:%g\n", i, (long long)(RRD_DATE + second), value);
	if (++rrd_asked == 100)
		rrd_answers();
}

static void rrd_second(int64_t second)
{
	(void)second;
	rrd_answers();
}

static void rrd_end(int64_t second)
{
	(void)second;
	fputs("quit\n", rrd_to);
	fclose(rrd_to);
	fclose(rrd_from);
	wait(NULL);
}

static const struct keeper keepers[] = {
	{"owsd", owsd_begin, owsd_value, owsd_second, owsd_end, false, NULL},
	{"sqlite", plain_begin, plain_value, plain_second, plain_end, false, NULL},
	{"w1retap", w1retap_begin, w1retap_value, w1retap_second, plain_end, true, NULL},
	{"rrdtool", rrd_begin, rrd_value, rrd_second, rrd_end, true, "rrdtool"},
};

/* --- Measuring -------------------------------------------------------------------------------- */

static double cpu_s(void)
{
	struct rusage own, children;

	getrusage(RUSAGE_SELF, &own);
	getrusage(RUSAGE_CHILDREN, &children);
	return (double)(own.ru_utime.tv_sec + own.ru_stime.tv_sec + children.ru_utime.tv_sec +
	                children.ru_stime.tv_sec) +
	       (double)(own.ru_utime.tv_usec + own.ru_stime.tv_usec + children.ru_utime.tv_usec +
	                children.ru_stime.tv_usec) /
	               1e6;
}

static double most_kb(int who)
{
	struct rusage used;

	getrusage(who, &used);
	return (double)used.ru_maxrss;
}

static void report(const char *plant, const struct keeper *keeper, const char *what, double value,
                   const char *unit)
{
	char name[64];

	snprintf(name, sizeof(name), "recorder.%s.%s.%s", plant, keeper->name, what);
	bench_line(name, value, unit);
}

struct plant {
	const char *name;
	unsigned count;
	double change;
	int64_t seconds[sizeof(keepers) / sizeof(keepers[0])]; /* 0: not measured */
};
static const struct plant plants[] = {
	{"50", 50, 0.15, {86400, 3600, 86400, 1800}},
	{"50.calm", 50, 0.016, {86400, 0, 0, 0}},
	{"10000", 10000, 0.15, {630, 90, 0, 60}},
};

/* In a process of its own, whose processor time and memory count. */
static void measure(const struct plant *plant, const struct keeper *keeper, int64_t seconds)
{
	unsigned count = plant->count;
	struct readings readings = readings_begin(count, plant->change);
	double before = 0, bytes, kept = 0, cpu = 0, used = most_kb(RUSAGE_SELF);
	double day = 86400 / (double)(seconds - KERNEL);
	char folder[sizeof(disk) + 32];
	time_t begun = 0;

	snprintf(folder, sizeof(folder), "%s/%s.%s", disk, keeper->name, plant->name);
	want(mkdir(folder, 0700) == 0, folder);
	keeper->begin(count, folder);
	for (int64_t now = 1; now <= seconds; now++) {
		for (unsigned i = 0; i < count; i++)
			if (readings_next(&readings, i) || keeper->each || now == 1)
				keeper->value(i, now, readings.values[i]);
		keeper->second(now);
		if (now % KERNEL == KERNEL / 2)
			sync_disk();
		else if (now % JOURNAL == JOURNAL / 2)
			commit_journal(folder);
		if (now == KERNEL) {
			before = sectors_written();
			kept = bytes_in(folder);
			cpu = cpu_s();
			begun = time(NULL);
		}
	}
	keeper->end(seconds);
	sync_disk();
	bytes = (sectors_written() - before) * 512;
	/* the kernel wrote more often than it does in that time */
	if (time(NULL) - begun > seconds - KERNEL)
		bench_note("recorder: slower than the readings come: no figure of what is written");
	else
		report(plant->name, keeper, "written_a_day", bytes * day / 1e6, "MB");
	report(plant->name, keeper, "growth_a_day", (bytes_in(folder) - kept) * day / 1e6, "MB");
	if (keeper->program)
		report(plant->name, keeper, "file", kept / 1e6, "MB");
	report(plant->name, keeper, "cpu", (cpu_s() - cpu) * 1e6 * day / 86400, "us/s");
	report(plant->name, keeper, "memory",
	       keeper->program ? most_kb(RUSAGE_CHILDREN) : most_kb(RUSAGE_SELF) - used, "kB");
	readings_end(&readings);
}

static bool is_here(const struct keeper *keeper)
{
	bool is = !keeper->program || !system("command -v rrdtool >/dev/null");

	if (!is)
		bench_note("recorder: rrdtool is not installed");
	return is;
}

/* --- Questions -------------------------------------------------------------------------------- */

#define DAYS 30
#define TIMES 15
#define OF_DAY "20028 * 86400" /* the last but one; DATE is the begin of day 20000 */

static const char *const questions[][3] = {
	/* keeper; a day of one signal; a month of it by hours */
	{"owsd",
         "select time, value from trend where name = 't7' and day = date(" OF_DAY
         ", 'unixepoch') order by id",
         "select time, mean from trend_hour where name = 't7' and day >= date(20000 * 86400,"
         " 'unixepoch')"},
	{"w1retap",
         "select date, value from readings where name = 't7' and date between " OF_DAY
         " and " OF_DAY " + 86399 order by date",
         "select date / 3600, avg(value) from readings where name = 't7' group by 1 order by 1"},
};

/* The processor's milliseconds of a question, with the opening of the file. */
static double ask_file(const char *path, const char *question)
{
	double begun = cpu_s();

	for (int i = 0; i < TIMES; i++) {
		sqlite3_stmt *answer = NULL;
		sqlite3 *file = NULL;
		int rows = 0;

		want(sqlite3_open_v2(path, &file, SQLITE_OPEN_READONLY, NULL) == SQLITE_OK &&
		             sqlite3_prepare_v2(file, question, -1, &answer, NULL) == SQLITE_OK,
		     question);
		while (sqlite3_step(answer) == SQLITE_ROW)
			rows++;
		want(rows > 24, question);
		sqlite3_finalize(answer);
		sqlite3_close(file);
	}
	return (cpu_s() - begun) * 1e3 / TIMES;
}

/* Its archives have their rows from the start, whether they are known or not. */
static double ask_rrd(const char *folder, int resolution, int seconds)
{
	double begun;

	begun = cpu_s();
	rrd_begin(8, folder);
	rrd_end(0);
	begun = 2 * begun - cpu_s(); /* less that */
	rrd_begin(8, folder);
	for (int i = 0; i < TIMES; i++) {
		char line[256] = "";

		fprintf(rrd_to, "fetch t7.rrd AVERAGE -r %d -s %d -e %d\n", resolution,
		        RRD_DATE - seconds, RRD_DATE - resolution);
		fflush(rrd_to);
		while (strncmp(line, "OK", 2))
			want(fgets(line, sizeof(line), rrd_from) && strncmp(line, "ERROR", 5) != 0,
			     "rrdtool fetch");
	}
	rrd_end(0);
	return (cpu_s() - begun) * 1e3 / TIMES;
}

static void ask_of(const struct keeper *keeper, const char *const *question)
{
	struct readings readings = readings_begin(50, 0.15);
	struct plant plant = {.name = "month"};
	char folder[sizeof(disk) + 32], path[sizeof(folder) + 32];

	/* in memory: what is measured is no disk */
	snprintf(folder, sizeof(folder), "%s/%s.month", bench_dir()->path, keeper->name);
	snprintf(path, sizeof(path), "%s/%s.sqlite", folder,
	         keeper == keepers ? "history" : keeper->name);
	want(mkdir(folder, 0700) == 0, folder);
	if (question) {
		keeper->begin(50, folder);
		for (int64_t now = ROUND; now < DAYS * 86400; now += ROUND) {
			for (unsigned i = 0; i < 50; i++)
				if (readings_next(&readings, i) || keeper->each || now == ROUND)
					keeper->value(i, now, readings.values[i]);
			keeper->second(now);
		}
		keeper->end(DAYS * 86400);
	}
	report(plant.name, keeper, "day_of_one",
	       question ? ask_file(path, question[1]) : ask_rrd(folder, 72, 86400), "ms");
	report(plant.name, keeper, "month_by_hours",
	       question ? ask_file(path, question[2]) : ask_rrd(folder, 2232, DAYS * 86400), "ms");
	readings_end(&readings);
}

static void in_a_process(const struct keeper *keeper, const struct plant *plant, int64_t seconds)
{
	const char *const *question = NULL;
	int status = 0;
	pid_t child;

	fflush(stdout);
	child = fork();
	if (child == 0) {
		for (size_t i = 0; i < sizeof(questions) / sizeof(questions[0]); i++)
			if (!strcmp(questions[i][0], keeper->name))
				question = questions[i];
		if (plant)
			measure(plant, keeper, seconds);
		else
			ask_of(keeper, question);
		fflush(stdout);
		_exit(0);
	}
	want(child > 0 && waitpid(child, &status, 0) == child && status == 0, keeper->name);
}

int main(int argc, char **argv)
{
	int64_t most = argc > 1 ? (int64_t)(atof(argv[1]) * 3600) : 86400;

	if (most <= KERNEL) {
		fputs("usage: bench_recorder [HOURS [DIRECTORY]]\n", stderr);
		return 2;
	}
	if (argc > 2) {
		snprintf(disk, sizeof(disk), "%s", argv[2]);
	} else if (!make_disk()) {
		bench_note("recorder: no loop device with ext4 here; as root, with mkfs.ext4");
		return 0;
	}
	for (size_t i = 0; i < sizeof(plants) / sizeof(plants[0]); i++) {
		for (size_t k = 0; k < sizeof(keepers) / sizeof(keepers[0]); k++) {
			int64_t seconds = plants[i].seconds[k];

			if (seconds && is_here(&keepers[k]))
				in_a_process(&keepers[k], &plants[i],
				             seconds < most ? seconds : most);
		}
	}
	for (size_t k = 0; k < sizeof(keepers) / sizeof(keepers[0]); k++)
		if (strcmp(keepers[k].name, "sqlite") != 0 && is_here(&keepers[k]))
			in_a_process(&keepers[k], NULL, 0);
	umount2(argc > 2 ? "" : disk, MNT_DETACH);
	return 0;
}
