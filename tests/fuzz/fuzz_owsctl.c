/* SPDX-License-Identifier: MIT */
/*
 * owsctl as a whole, main() and all verbs: its words are the lines of the input up to an empty one.
 * What comes behind is what a target answers, or the configuration file. No file is written and no
 * bus opened; time is virtual, and who waits for ever is ended.
 */
#include "hal/bus/bus.h"
#include "src/config/edit/replace.h"
#include "src/config/read/config.h"
#include "src/config/read/load.h"
#include "src/ground/board/board.h"
#include "src/ground/signal/value.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/heap_instance.h"
#include "tests/fuzz/json_valid.h"

int owsctl_main(int argc, char **argv);
#define main owsctl_main
#include "src/tool/owsctl/owsctl.c"
#undef main

#include <errno.h>
#include <fcntl.h>
#include <setjmp.h>
#include <stdlib.h>
#include <time.h>

#define WORDS 16
#define WAITS 40
#define NAPS 1000
#define HANDLES 16
#define WALL_S INT64_C(1800000000)

static struct fuzz fuzz;
static int64_t now_ns;
static unsigned waits, naps;
static jmp_buf out_of_it;
static bool running;
static struct ows *handles[HANDLES];

size_t fuzz_memory(size_t n)
{
	/* what was printed, a listing of a target, tables */
	return 4000000 + 2000 * n;
}

/* --- In the place of what lies below ---------------------------------------------------------- */

_Noreturn void __real_exit(int status);
_Noreturn void __wrap_exit(int status);
_Noreturn void __wrap_exit(int status)
{
	if (running)
		longjmp(out_of_it, 1 + status);
	__real_exit(status);
}

int64_t __wrap_ows_now(void);
int64_t __wrap_ows_now(void)
{
	return now_ns;
}

/* Time passes for who looks at the clock again and again, too. */
int __wrap_clock_gettime(clockid_t clock, struct timespec *at);
int __wrap_clock_gettime(clockid_t clock, struct timespec *at)
{
	int64_t ns = now_ns += 1000000;

	if (clock == CLOCK_REALTIME)
		ns += WALL_S * 1000000000;
	*at = (struct timespec){ns / 1000000000, ns % 1000000000};
	return 0;
}

time_t __wrap_time(time_t *at);
time_t __wrap_time(time_t *at)
{
	(void)at;
	return now_ns / 1000000000 + WALL_S;
}

/* Values change while somebody waits for it, but not for ever. */
int __wrap_segment_wait(const uint32_t *word, uint32_t seen, int64_t timeout_ns);
int __wrap_segment_wait(const uint32_t *word, uint32_t seen, int64_t timeout_ns)
{
	(void)word, (void)seen;
	if (++waits == WAITS)
		longjmp(out_of_it, 100);
	now_ns += timeout_ns < 0 ? 1000000000 : timeout_ns;
	/* all limits that can be given are over then */
	if (waits == WAITS / 2)
		now_ns += INT64_C(367) * 86400 * 1000000000;
	if (waits % 3 == 0)
		heap_put(1 + waits % HEAP_SIGNALS, (int64_t)waits / 9 % 2, "other", now_ns, waits);
	if (waits % 7 == 0)
		heap_beat(now_ns);
	return waits % 3 ? -ETIMEDOUT : 0;
}

int __wrap_nanosleep(const struct timespec *time, struct timespec *left);
int __wrap_nanosleep(const struct timespec *time, struct timespec *left)
{
	(void)left;
	if (++naps == NAPS)
		longjmp(out_of_it, 100);
	now_ns += (int64_t)time->tv_sec * 1000000000 + time->tv_nsec;
	return 0;
}

bool __wrap_ctl_reader_gone(void);
bool __wrap_ctl_reader_gone(void)
{
	return waits >= WAITS - 5;
}

void __wrap_terminal_catch_signals(void);
void __wrap_terminal_catch_signals(void)
{
}

int __wrap_isatty(int fd);
int __wrap_isatty(int fd)
{
	(void)fd;
	return 0;
}

/* owsctl ends without closing what it opened when it is ended. */
static int keep(int err, struct ows **h)
{
	for (int i = 0; !err && i < HANDLES; i++)
		if (!handles[i]) {
			handles[i] = *h;
			break;
		}
	return err;
}

int __real_ows_open(const char *instance, enum ows_mode mode, struct ows **h);
int __wrap_ows_open(const char *instance, enum ows_mode mode, struct ows **h);
int __wrap_ows_open(const char *instance, enum ows_mode mode, struct ows **h)
{
	return keep(strcmp(instance, "nobody") ? __real_ows_open(instance, mode, h) : -ENOENT, h);
}

int __real_ows_open_as(const char *instance, enum ows_mode mode, const char *name, struct ows **h);
int __wrap_ows_open_as(const char *instance, enum ows_mode mode, const char *name, struct ows **h);
int __wrap_ows_open_as(const char *instance, enum ows_mode mode, const char *name, struct ows **h)
{
	return keep(strcmp(instance, "nobody") ? __real_ows_open_as(instance, mode, name, h)
	                                       : -ENOENT,
	            h);
}

int __real_open_in(const char *dir, const char *instance, enum ows_mode mode, const char *name,
                   struct ows **h);
int __wrap_open_in(const char *dir, const char *instance, enum ows_mode mode, const char *name,
                   struct ows **h);
int __wrap_open_in(const char *dir, const char *instance, enum ows_mode mode, const char *name,
                   struct ows **h)
{
	return keep(__real_open_in(dir, instance, mode, name, h), h);
}

void __real_ows_close(struct ows *h);
void __wrap_ows_close(struct ows *h);
void __wrap_ows_close(struct ows *h)
{
	for (int i = 0; i < HANDLES; i++)
		if (handles[i] == h)
			handles[i] = NULL;
	__real_ows_close(h);
}

int __wrap_board_look(const char *root, const char *folder, const char *board,
                      struct board_report *report, char *why, size_t why_size);
int __wrap_board_look(const char *root, const char *folder, const char *board,
                      struct board_report *report, char *why, size_t why_size)
{
	(void)root, (void)folder, (void)board, (void)report, (void)why, (void)why_size;
	return -ENOENT;
}

int __wrap_replace_file(const char *file, const char *text, size_t len);
int __wrap_replace_file(const char *file, const char *text, size_t len)
{
	(void)file, (void)text, (void)len;
	return 0;
}

int __wrap_replace_lock(const char *file);
int __wrap_replace_lock(const char *file)
{
	(void)file;
	return open("/dev/null", O_RDONLY | O_CLOEXEC);
}

void __wrap_replace_unlock(const char *file, int fd);
void __wrap_replace_unlock(const char *file, int fd)
{
	(void)file;
	close(fd);
}

int __wrap_rio_read(const char *file, struct config_report *report, char **text, size_t *len);
int __wrap_rio_read(const char *file, struct config_report *report, char **text, size_t *len)
{
	(void)file, (void)report;
	*len = fuzz_left(&fuzz);
	*text = malloc(*len + 1);
	TEST_ASSERT_NOT_NULL(*text);
	if (*len)
		memcpy(*text, fuzz.at, *len);
	(*text)[*len] = '\0';
	return 0;
}

/* A target that answers what the input says. */
static void answer(struct bus *bus, struct bus_req *req, struct bus_answer *answer)
{
	static const int errors[] = {0, 0, 0, -ENODEV, -ENOENT, -EISDIR, -EACCES, -EIO};
	static const char *const lines[] = {"/28.A10000000000\n", "/29.B10000000000\n",
	                                    "/10.C10000000000\n", "/26.D10000000000\n"};
	uint8_t what = fuzz_byte(&fuzz);
	size_t n = 0, used = 0;
	const uint8_t *bytes;

	(void)bus;
	answer->err = errors[what & 7];
	answer->detail = what >> 3 & 1 ? BUS_DETAIL_SIMULATED : 0;
	if (answer->err || (req->op != BUS_READ && req->op != BUS_DIR))
		return;
	for (int i = 0; req->op == BUS_DIR && i < 4; i++)
		if (what >> (4 + i) & 1 && req->len - used > 20) {
			memcpy(req->data + used, lines[i], strlen(lines[i]));
			used += strlen(lines[i]);
		}
	bytes = fuzz_bytes(&fuzz, req->len - used < 255 ? req->len - used : 255, &n);
	if (n)
		memcpy(req->data + used, bytes, n);
	for (size_t i = used; req->op == BUS_DIR && i < used + n; i++)
		if (!req->data[i] || i + 1 == used + n)
			req->data[i] = '\n';
	answer->len = (uint32_t)(used + n);
}

static void destroy(struct bus *bus)
{
	free(bus);
}

static const struct bus_ops fuzz_bus = {
	.scheme = "fuzz", .summary = "", .depth = 4, .destroy = destroy, .exec = answer};

int __wrap_bus_create(const char *target, const struct bus_env *env, struct bus **bus, char *why,
                      size_t why_size);
int __wrap_bus_create(const char *target, const struct bus_env *env, struct bus **bus, char *why,
                      size_t why_size)
{
	if (target[0] == '!') {
		snprintf(why, why_size, "no such target");
		return -EINVAL;
	}
	*bus = calloc(1, sizeof(**bus));
	TEST_ASSERT_NOT_NULL(*bus);
	return bus_init(*bus, &fuzz_bus, env);
}

/* --- What is printed -------------------------------------------------------------------------- */

static void check_messages(const char *text, size_t n)
{
	for (size_t i = 0; i < n; i++)
		TEST_ASSERT_TRUE_MESSAGE((unsigned char)text[i] >= ' ' || text[i] == '\n' ||
		                                 text[i] == '\t',
		                         "a message steers the terminal");
}

static void check_json(const char *text, size_t n)
{
	while (n) {
		const char *end = memchr(text, '\n', n);
		size_t len = end ? (size_t)(end - text) : n;

		TEST_ASSERT_TRUE_MESSAGE(json_valid(text, len), "no JSON");
		text += len + (end != NULL);
		n -= len + (end != NULL);
	}
}

static void ignore(void *ctx, bool is_error, const char *message)
{
	(void)ctx, (void)is_error, (void)message;
}

/* What scan --rio proposes is a configuration. */
static void check_rio(const char *text, size_t n)
{
	struct config_report report = {.line = ignore};
	struct config *config;
	const char *driver = strstr(text, "OwsDrv {\n");

	if (!driver || (driver != text && driver[-1] != '\n'))
		return;
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, config_parse("f", text, n, &report, &config),
	                              "what scan --rio says is no configuration");
	config_free(config);
}

/* As the program is started; its status, or above 99: it was ended. */
static int run(int argc, char **argv, char **out, size_t *out_n, char **err, size_t *err_n)
{
	FILE *real_out = stdout, *real_err = stderr, *volatile caught_out, *volatile caught_err;
	volatile int status = 0;
	int how;

	caught_out = open_memstream(out, out_n);
	caught_err = open_memstream(err, err_n);
	TEST_ASSERT_TRUE(caught_out && caught_err);
	stdout = caught_out;
	stderr = caught_err;
	running = true;
	optind = 0;
	opterr = 1;
	how = setjmp(out_of_it);
	if (how == 0)
		status = owsctl_main(argc, argv);
	else
		status = how == 100 ? 100 : 101;
	running = false;
	stdout = real_out;
	stderr = real_err;
	fclose(caught_out);
	fclose(caught_err);
	for (int i = 0; i < HANDLES; i++)
		if (handles[i])
			__wrap_ows_close(handles[i]);
	return status;
}

void fuzz_one(const uint8_t *bytes, size_t n)
{
	static char words[WORDS][300];
	char *argv[WORDS + 2], *out = NULL, *err = NULL;
	size_t out_n, err_n;
	int argc = 1, status;

	fuzz = (struct fuzz){bytes, bytes + n};
	now_ns = HEAP_START;
	waits = naps = 0;
	heap_instance_reset();
	argv[0] = (char *)(uintptr_t) "owsctl";
	while (argc <= WORDS && fuzz_left(&fuzz)) {
		argv[argc] = words[argc - 1];
		if (!*fuzz_line(&fuzz, words[argc - 1], sizeof(words[0])))
			break;
		argc++;
	}
	argv[argc] = NULL;
	status = run(argc, argv, &out, &out_n, &err, &err_n);
	TEST_ASSERT_TRUE((status >= CTL_DONE && status <= CTL_NOTHING) || status == 100 ||
	                 status == 101);
	TEST_ASSERT_TRUE_MESSAGE(status != CTL_USAGE || err_n, "wrong usage, and nothing is said");
	check_messages(err, err_n);
	/* -h prints the help of the verb wherever it stands */
	if (argc > 2 && !strcmp(argv[1], "--json") && argv[2][0] != '-' && status < 100 &&
	    strncmp(out, "usage: ", strlen("usage: ")) != 0)
		check_json(out, out_n);
	if (status == CTL_DONE && argc > 1 && !strcmp(argv[1], "scan"))
		check_rio(out, out_n);
	free(out);
	free(err);
}
