/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cv_guard.hpp - what every shim over OpenCV works under: no exception leaves, OpenCV says nothing by itself, and one
 * operation of its runs in one thread. For the cv_*.cpp alone. */
#ifndef SG_IMAGE_CV_GUARD_HPP
#define SG_IMAGE_CV_GUARD_HPP

#include "core/status.h"

#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>

#include <exception>
#include <new>

/** Once a process. */
inline void sg_cv_settle()
{
    static const bool done = [] {
        cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
        cv::setNumThreads(1);
        return true;
    }();
    (void)done;
}

/** Run work(), which returns a status. What it throws becomes SG_ENOMEM, or `otherwise` with OpenCV's sentence. */
template <typename Work> sg_status sg_cv_guarded(sg_error *err, sg_status otherwise, Work work) noexcept
{
    try {
        sg_cv_settle();
        return work();
    } catch (const std::bad_alloc &) {
        return SG_FAIL_NOMEM(err);
    } catch (const cv::Exception &e) {
        if (e.code == cv::Error::StsNoMem)
            return SG_FAIL_NOMEM(err);
        return SG_FAIL(err, otherwise, "OpenCV: %s", e.err.c_str());
    } catch (const std::exception &e) {
        return SG_FAIL(err, otherwise, "OpenCV: %s", e.what());
    } catch (...) {
        return SG_FAIL(err, otherwise, "OpenCV failed");
    }
}

#endif
