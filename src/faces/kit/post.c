/* SPDX-License-Identifier: MIT */
/*
 * One POST at a time, by libcurl's multi interface: libcurl names the descriptors and the time that
 * it waits for, and the loop of the face waits for them beside its own.
 */
#include <curl/curl.h>
#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/faces/kit/post.h"
#include "src/ground/text/printable.h"
#include "src/public/ows.h"

#define CONNECT_S 10L
#define ANSWER_S 20L

struct post {
	void (*watch)(void *ctx, int fd, short events);
	void *ctx;
	CURLM *multi;
	CURL *easy;
	struct curl_slist *headers;
	bool busy;
	int64_t next_ns;
	char error[CURL_ERROR_SIZE];
	char words[POST_WORDS];
	size_t len;
};

static int on_socket(CURL *easy, curl_socket_t fd, int what, void *ctx, void *unused)
{
	struct post *post = ctx;
	short events = 0;

	(void)easy, (void)unused;
	if (what == CURL_POLL_IN || what == CURL_POLL_INOUT)
		events |= POLLIN;
	if (what == CURL_POLL_OUT || what == CURL_POLL_INOUT)
		events |= POLLOUT;
	post->watch(post->ctx, fd, events);
	return 0;
}

static int on_timer(CURLM *multi, long ms, void *ctx)
{
	struct post *post = ctx;

	(void)multi;
	post->next_ns = ms < 0 ? INT64_MAX : ows_now() + ms * NS_PER_MS;
	return 0;
}

/* The first words are kept, the rest is passed over. */
static size_t on_answer(char *data, size_t size, size_t n, void *ctx)
{
	struct post *post = ctx;
	size_t len = size * n, room = sizeof(post->words) - 1 - post->len;

	if (room > len)
		room = len;
	memcpy(post->words + post->len, data, room);
	post->len += room;
	return len;
}

/* What never changes. */
static bool set_up(struct post *post)
{
	CURL *e = post->easy;

	curl_multi_setopt(post->multi, CURLMOPT_SOCKETFUNCTION, on_socket);
	curl_multi_setopt(post->multi, CURLMOPT_SOCKETDATA, post);
	curl_multi_setopt(post->multi, CURLMOPT_TIMERFUNCTION, on_timer);
	curl_multi_setopt(post->multi, CURLMOPT_TIMERDATA, post);
#if LIBCURL_VERSION_NUM >= 0x075700
	/* the end does not wait for a thread that looks a name up */
	curl_easy_setopt(e, CURLOPT_QUICK_EXIT, 1L);
#endif
	return !curl_easy_setopt(e, CURLOPT_NOSIGNAL, 1L) &&
	       !curl_easy_setopt(e, CURLOPT_POST, 1L) &&
	       !curl_easy_setopt(e, CURLOPT_USERAGENT, "owsd/" OWSD_VERSION) &&
	       !curl_easy_setopt(e, CURLOPT_CONNECTTIMEOUT, CONNECT_S) &&
	       !curl_easy_setopt(e, CURLOPT_TIMEOUT, ANSWER_S) &&
	       !curl_easy_setopt(e, CURLOPT_ERRORBUFFER, post->error) &&
	       !curl_easy_setopt(e, CURLOPT_WRITEFUNCTION, on_answer) &&
	       !curl_easy_setopt(e, CURLOPT_WRITEDATA, post);
}

struct post *post_open(void (*watch)(void *ctx, int fd, short events), void *ctx)
{
	struct post *post = calloc(1, sizeof(*post));

	if (!post)
		return NULL;
	post->watch = watch;
	post->ctx = ctx;
	post->next_ns = INT64_MAX;
	if (curl_global_init(CURL_GLOBAL_DEFAULT)) {
		free(post);
		return NULL;
	}
	post->multi = curl_multi_init();
	post->easy = curl_easy_init();
	if (post->multi && post->easy && set_up(post))
		return post;
	post_close(post);
	return NULL;
}

void post_close(struct post *post)
{
	if (!post)
		return;
	post_cancel(post);
	curl_easy_cleanup(post->easy);
	if (post->multi)
		curl_multi_cleanup(post->multi);
	curl_slist_free_all(post->headers);
	curl_global_cleanup();
	free(post);
}

static bool add_header(struct post *post, const char *text)
{
	struct curl_slist *more = curl_slist_append(post->headers, text);

	if (more)
		post->headers = more;
	return more;
}

static bool make_headers(struct post *post, const struct post_what *what)
{
	char line[POST_HEADER];
	bool made;

	curl_slist_free_all(post->headers);
	post->headers = NULL;
	snprintf(line, sizeof(line), "Content-Type: %s", what->type);
	made = add_header(post, line) && add_header(post, "Expect:");
	snprintf(line, sizeof(line), "Authorization: %s %s", what->scheme, what->token);
	return made && (!*what->token || add_header(post, line));
}

int post_begin(struct post *post, const struct post_what *what)
{
	CURL *e = post->easy;

	post->len = 0;
	post->error[0] = '\0';
	if (!make_headers(post, what) || curl_easy_setopt(e, CURLOPT_URL, what->url) ||
	    curl_easy_setopt(e, CURLOPT_HTTPHEADER, post->headers) ||
	    curl_easy_setopt(e, CURLOPT_POSTFIELDSIZE_LARGE, (curl_off_t)what->len) ||
	    curl_easy_setopt(e, CURLOPT_POSTFIELDS, what->data) ||
	    curl_multi_add_handle(post->multi, e))
		return -ENOMEM;
	post->busy = true;
	return 0;
}

bool post_is_busy(const struct post *post)
{
	return post->busy;
}

static void finish_post(struct post *post, CURLcode code, struct post_result *result)
{
	const char *why = *post->error ? post->error : curl_easy_strerror(code);
	size_t len;

	curl_easy_getinfo(post->easy, CURLINFO_RESPONSE_CODE, &result->status);
	post->words[post->len] = '\0';
	if (code) {
		result->status = 0;
		snprintf(result->words, sizeof(result->words), "%.*s", POST_WORDS, why);
	} else {
		snprintf(result->words, sizeof(result->words), "HTTP %ld: %s",
		         result->status % 1000, post->words);
	}
	len = printable(result->words, strcspn(result->words, "\r\n"));
	result->words[len] = '\0';
	post_cancel(post);
}

/* There is one transfer, so the first message that one is done is of it, and the last. */
static bool is_over(struct post *post, struct post_result *result)
{
	CURLMsg *message;
	int left;

	while ((message = curl_multi_info_read(post->multi, &left)))
		if (message->msg == CURLMSG_DONE && post->busy) {
			finish_post(post, message->data.result, result);
			return true;
		}
	return false;
}

bool post_step(struct post *post, int fd, short ready, struct post_result *result)
{
	int flags = 0, running;

	if (ready & (POLLIN | POLLHUP))
		flags |= CURL_CSELECT_IN;
	if (ready & POLLOUT)
		flags |= CURL_CSELECT_OUT;
	if (ready & (POLLERR | POLLNVAL))
		flags |= CURL_CSELECT_ERR;
	if (fd < 0)
		post->next_ns = INT64_MAX;
	curl_multi_socket_action(post->multi, fd < 0 ? CURL_SOCKET_TIMEOUT : fd, flags, &running);
	return is_over(post, result);
}

bool post_wait(struct post *post, int64_t until_ns, struct post_result *result)
{
	int running;

	while (post->busy && ows_now() < until_ns) {
		curl_multi_poll(post->multi, NULL, 0, 50, NULL);
		curl_multi_perform(post->multi, &running);
		if (is_over(post, result))
			return true;
	}
	return false;
}

int64_t post_next(const struct post *post)
{
	return post->next_ns;
}

void post_cancel(struct post *post)
{
	if (post->busy)
		curl_multi_remove_handle(post->multi, post->easy);
	post->busy = false;
}
