/* SPDX-License-Identifier: GPL-3.0-or-later */
/* program.c - what every program's main shares. The only file with state of its own: a process has one standard error,
 * one set of signal handlers and one bar. */
#include "config.h"

#include "program/program.h"

#include "core/file.h"

#include <errno.h>
#include <fcntl.h>
#include <gsl/gsl_errno.h>
#include <math.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const char *program_name = "shapegram";
static volatile sig_atomic_t interrupted;

static struct {
    char step[64];
    double started, shown; /* seconds */
    bool on_terminal, bar_drawn;
} bar;

static void on_signal(int signal_number)
{
    (void)signal_number;
    interrupted = 1;
}

/* A file opened by a program whose standard output is closed would get that number, and with it what is printed. What
 * takes the place here opens the wrong way round, so that its use fails as it would have. */
static void guard_standard_streams(void)
{
    for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; fd++)
        if (fcntl(fd, F_GETFD) < 0 && open("/dev/null", fd == STDIN_FILENO ? O_WRONLY : O_RDONLY) < 0)
            return;
}

void sg_program_begin(const char *name)
{
    program_name = name;
    guard_standard_streams();
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = on_signal;
    /* The second signal ends the process: a step that does not look at the flag can still be stopped. */
    action.sa_flags = SA_RESETHAND | SA_RESTART;
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    /* A reader that goes away, or a file size limit, is a failed write with a message and not a silent death. */
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN);
    gsl_set_error_handler_off();
}

__attribute__((format(printf, 1, 0))) static void complain_list(const char *format, va_list ap)
{
    sg_program_progress_end();
    fprintf(stderr, "%s: ", program_name);
    vfprintf(stderr, format, ap);
    fputc('\n', stderr);
}

void sg_program_complain(const char *format, ...)
{
    va_list ap;
    va_start(ap, format);
    complain_list(format, ap);
    va_end(ap);
}

int sg_program_usage(const char *format, ...)
{
    va_list ap;
    va_start(ap, format);
    complain_list(format, ap);
    va_end(ap);
    fprintf(stderr, "Try '%s --help'.\n", program_name);
    return 2;
}

int sg_program_end(sg_status status, const sg_error *err)
{
    sg_program_progress_end();
    if (status == SG_STOPPED)
        sg_program_complain("stopped; what was found so far is written");
    else if (status != SG_OK)
        sg_program_complain("%s", err != NULL && err->msg[0] != '\0' ? err->msg : "failed");
    errno = 0;
    if ((fflush(stdout) != 0 || ferror(stdout)) && (status == SG_OK || status == SG_STOPPED)) {
        sg_program_complain("standard output: %s", errno != 0 ? strerror(errno) : "writing failed");
        status = SG_EIO;
    }
    return sg_exit_code(status);
}

bool sg_program_size(const char *option, const char *arg, size_t low, size_t high, size_t *out)
{
    char *end;
    errno = 0;
    const unsigned long long v = strtoull(arg, &end, 10);
    if (errno != 0 || end == arg || *end != '\0' || strchr(arg, '-') != NULL || v < low || v > high) {
        sg_program_usage("%s: '%s' is no whole number from %zu to %zu", option, arg, low, high);
        return false;
    }
    *out = (size_t)v;
    return true;
}

bool sg_program_double(const char *option, const char *arg, double low, double high, double *out)
{
    char *end;
    const double v = strtod(arg, &end);
    if (end == arg || *end != '\0' || !(v >= low && v <= high)) {
        sg_program_usage("%s: '%s' is no number from %g to %g", option, arg, low, high);
        return false;
    }
    *out = v + 0.0; /* -0 becomes 0 */
    return true;
}

sg_status sg_program_spare(const char *output, const char *const *inputs, size_t n, sg_error *err)
{
    for (size_t i = 0; output != NULL && strcmp(output, "-") != 0 && i < n; i++)
        if (inputs[i] != NULL && sg_file_exists(output) && sg_file_same(output, inputs[i]))
            return SG_FAIL(err, SG_EINVAL, "%s: this is read; it will not be written over", output);
    return SG_OK;
}

sg_status sg_program_apart(const char *output, const char *const *others, size_t n, sg_error *err)
{
    for (size_t i = 0; output != NULL && i < n; i++)
        if (others[i] != NULL && sg_file_same_place(output, others[i]))
            return SG_FAIL(err, SG_EINVAL, "%s: two results would be this file", output);
    return SG_OK;
}

bool sg_program_choice(const char *option, const char *arg, const char *const *choices, int *out)
{
    char list[512] = "";
    for (int i = 0; choices[i] != NULL; i++) {
        if (strcmp(choices[i], arg) == 0) {
            *out = i;
            return true;
        }
        const size_t n = strlen(list);
        snprintf(list + n, sizeof list - n, "%s%s", i > 0 ? ", " : "", choices[i]);
    }
    sg_program_usage("%s: '%s' is none of %s", option, arg, list);
    return false;
}

bool sg_program_choices(const char *option, const char *arg, const char *const *choices, unsigned *out)
{
    enum { LONGEST = 31 };
    *out = 0;
    for (const char *p = arg;; p++) {
        const size_t length = strcspn(p, ",");
        char word[LONGEST + 1];
        int which;
        snprintf(word, sizeof word, "%.*s", (int)(length < LONGEST ? length : LONGEST), p);
        if (!sg_program_choice(option, word, choices, &which))
            return false;
        *out |= 1U << which;
        p += length;
        if (*p == '\0')
            return true;
    }
}

static void print_version(void)
{
    printf("%s (shapegram) %s\nLicence GPL-3.0-or-later: free software, without any warranty.\n", program_name,
           PACKAGE_VERSION);
}

sg_option_result sg_program_option(int opt, const char *arg, const char *help, sg_common_opts *opts)
{
    size_t n = 0;
    switch (opt) {
    case SG_OPT_HELP:
        fputs(help, stdout);
        return SG_OPTION_EXIT_OK;
    case SG_OPT_VERSION:
        print_version();
        return SG_OPTION_EXIT_OK;
    case SG_OPT_SEED:
        if (!sg_program_size("--seed", arg, 0, INT64_MAX, &n))
            return SG_OPTION_BAD;
        opts->seed = n;
        return SG_OPTION_TAKEN;
    case SG_OPT_THREADS:
        if (!sg_program_size("--threads", arg, 1, 1024, &n))
            return SG_OPTION_BAD;
        opts->threads = (int)n;
        return SG_OPTION_TAKEN;
    case SG_OPT_QUIET:
        opts->quiet = true;
        return SG_OPTION_TAKEN;
    case SG_OPT_JSON:
        opts->json = arg;
        return SG_OPTION_TAKEN;
    case '?':
    case ':': /* getopt_long() has said why */
        fprintf(stderr, "Try '%s --help'.\n", program_name);
        return SG_OPTION_BAD;
    default:
        return SG_OPTION_OTHER;
    }
}

int sg_program_options(int argc, char **argv, const char *short_options, const struct option *long_options,
                       const char *help, sg_common_opts *common, bool (*take)(int opt, const char *arg, void *user),
                       void *user)
{
    for (int opt; (opt = getopt_long(argc, argv, short_options, long_options, NULL)) != -1;) {
        const sg_option_result result = sg_program_option(opt, optarg, help, common);
        if (result == SG_OPTION_EXIT_OK)
            return sg_program_end(SG_OK, NULL);
        if (result == SG_OPTION_BAD || (result == SG_OPTION_OTHER && !take(opt, optarg, user)))
            return 2;
    }
    return -1;
}

static double now_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void draw_bar(const char *step, size_t done, size_t total, double elapsed)
{
    enum { WIDTH = 30 };
    const double rate = elapsed > 0 ? (double)done / elapsed : 0;
    if (total == 0) {
        fprintf(stderr, "\r\033[K%s: %zu (%.3g/s)", step, done, rate);
    } else {
        char cells[WIDTH + 1];
        const size_t full = done >= total ? WIDTH : done * WIDTH / total;
        for (size_t i = 0; i < WIDTH; i++)
            cells[i] = i < full ? '#' : '.';
        cells[WIDTH] = '\0';
        fprintf(stderr, "\r\033[K%s [%s] %zu/%zu  %.3g/s", step, cells, done, total, rate);
        if (rate > 0 && done < total)
            fprintf(stderr, "  %.0f s left", (double)(total - done) / rate);
    }
    bar.bar_drawn = true;
    fflush(stderr);
}

static void report(sg_progress *self, const char *step, size_t done, size_t total)
{
    (void)self;
    const double t = now_s();
    const bool fresh = strncmp(step, bar.step, sizeof bar.step - 1) != 0;
    if (fresh) {
        snprintf(bar.step, sizeof bar.step, "%s", step);
        bar.started = bar.shown = t;
    }
    const double pause = bar.on_terminal ? 0.1 : 10.0;
    if (t - bar.shown < pause)
        return;
    bar.shown = t;
    if (bar.on_terminal)
        draw_bar(step, done, total, t - bar.started);
    else if (total > 0)
        fprintf(stderr, "%s: %s: %zu of %zu, %.0f s\n", program_name, step, done, total, t - bar.started);
    else
        fprintf(stderr, "%s: %s: %zu, %.0f s\n", program_name, step, done, t - bar.started);
}

static bool stop(sg_progress *self)
{
    (void)self;
    return interrupted != 0;
}

sg_progress sg_program_progress(const sg_common_opts *opts)
{
    bar.on_terminal = isatty(STDERR_FILENO) != 0;
    return (sg_progress){opts->quiet ? NULL : report, stop, NULL};
}

void sg_program_progress_end(void)
{
    if (bar.bar_drawn)
        fputs("\r\033[K", stderr);
    bar.bar_drawn = false;
}
