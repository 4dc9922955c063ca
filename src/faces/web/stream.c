/* SPDX-License-Identifier: MIT */
/* Answers that are made piece by piece. */
#include <microhttpd.h>
#include <stdlib.h>
#include <string.h>

#include "src/faces/web/http.h"
#include "src/faces/web/stream.h"

#define BLOCK 4096

/* False: no memory. */
static bool refill(struct stream *stream, enum stream_more *more)
{
	FILE *out;

	free(stream->text);
	stream->text = NULL;
	stream->len = stream->at = 0;
	out = open_memstream(&stream->text, &stream->len);
	if (!out)
		return false;
	*more = stream->fill(stream, out);
	return fclose(out) == 0 && stream->text;
}

static ssize_t pull(void *cls, uint64_t position, char *buffer, size_t most)
{
	struct stream *stream = cls;
	enum stream_more more = STREAM_END;
	size_t n;

	(void)position;
	while (stream->at == stream->len) {
		if (stream->ended || stream->web->ends)
			return MHD_CONTENT_READER_END_OF_STREAM;
		if (!refill(stream, &more) || more == STREAM_BROKEN)
			return MHD_CONTENT_READER_END_WITH_ERROR;
		stream->ended = more == STREAM_END;
		if (more != STREAM_SLEEP || stream->len)
			continue;
		stream->asleep = true;
		MHD_suspend_connection(stream->connection);
		return 0;
	}
	n = stream->len - stream->at < most ? stream->len - stream->at : most;
	memcpy(buffer, stream->text + stream->at, n);
	stream->at += n;
	return (ssize_t)n;
}

static void stream_forget(void *cls)
{
	struct stream *stream = cls;
	struct web *web = stream->web;

	*(stream->before ? &stream->before->next : &web->streams) = stream->next;
	if (stream->next)
		stream->next->before = stream->before;
	web->stream_count--;
	free(stream->text);
	free(stream);
}

int stream_answer(struct request *request, const char *type, const struct stream *first)
{
	struct web *web = request->web;
	struct MHD_Response *response;
	struct stream *stream;

	if (web->stream_count >= STREAMS)
		return http_error(request, 503, "too many streams: close another page");
	stream = malloc(sizeof(*stream));
	if (!stream)
		return MHD_NO;
	*stream = *first;
	stream->web = web;
	stream->connection = request->connection;
	stream->before = NULL;
	stream->next = web->streams;
	if (stream->next)
		stream->next->before = stream;
	web->streams = stream;
	web->stream_count++;
	response = MHD_create_response_from_callback(MHD_SIZE_UNKNOWN, BLOCK, pull, stream,
	                                             stream_forget);
	if (!response)
		stream_forget(stream);
	else
		MHD_add_response_header(response, "Content-Type", type);
	/* no chunks: of those libmicrohttpd sends the end, of no body, too */
	if (response && request->head)
		MHD_set_response_options(response, MHD_RF_HTTP_VERSION_1_0_ONLY, MHD_RO_END);
	return http_answer(request, 200, response);
}

void stream_wake_all(struct web *web)
{
	for (struct stream *stream = web->streams; stream; stream = stream->next) {
		if (!stream->asleep)
			continue;
		stream->asleep = false;
		MHD_resume_connection(stream->connection);
	}
}
