/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cv_forest.cpp - OpenCV's RTrees behind cv_forest.h. */
#include "config.h"

#include "parse/cv_forest.h"

#include "image/cv_guard.hpp"

#include <opencv2/ml.hpp>

#include <climits>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <vector>

struct sg_cv_samples {
    cv::Ptr<cv::ml::TrainData> data;
    size_t nfeatures;
};

struct sg_cv_forest {
    cv::Ptr<cv::ml::RTrees> trees;
    size_t nfeatures;
};

namespace
{

/* OpenCV's headers know no read-only data; training and prediction only read. */
cv::Mat view(const float *x, size_t rows, size_t cols)
{
    return cv::Mat(static_cast<int>(rows), static_cast<int>(cols), CV_32F, const_cast<float *>(x));
}

bool fits(size_t n, size_t nfeatures)
{
    return n > 0 && nfeatures > 0 && n <= INT_MAX / 2 && nfeatures <= INT_MAX / 2;
}

sg_status take_samples(const float *x, size_t n, size_t nfeatures, const uint8_t *classes, sg_cv_samples **out)
{
    cv::Mat responses(static_cast<int>(n), 1, CV_32S);
    for (size_t i = 0; i < n; i++)
        responses.at<int>(static_cast<int>(i)) = classes[i];
    auto s = std::make_unique<sg_cv_samples>();
    s->nfeatures = nfeatures;
    s->data = cv::ml::TrainData::create(view(x, nfeatures, n), cv::ml::COL_SAMPLE, responses);
    *out = s.release();
    return SG_OK;
}

size_t active_features(const sg_cv_samples *s, const sg_cv_forest_opts *o)
{
    if (o->active > 0)
        return o->active;
    return static_cast<size_t>(std::lround(std::sqrt(static_cast<double>(s->nfeatures))));
}

sg_status grow(const sg_cv_samples *s, const sg_cv_forest_opts *o, uint64_t seed, sg_cv_forest **out, sg_error *err)
{
    auto f = std::make_unique<sg_cv_forest>();
    f->nfeatures = s->nfeatures;
    f->trees = cv::ml::RTrees::create();
    f->trees->setMaxDepth(static_cast<int>(o->depth));
    f->trees->setMinSampleCount(static_cast<int>(o->min_leaf));
    f->trees->setActiveVarCount(static_cast<int>(active_features(s, o)));
    f->trees->setCalculateVarImportance(false);
    f->trees->setTermCriteria(cv::TermCriteria(cv::TermCriteria::MAX_ITER, static_cast<int>(o->trees), 0));
    cv::theRNG().state = seed;
    if (!f->trees->train(s->data) || f->trees->getRoots().size() != o->trees)
        return SG_FAIL(err, SG_ENUMERIC, "OpenCV has grown no forest");
    *out = f.release();
    return SG_OK;
}

/* OpenCV holds the nodes of all trees in one array, where nothing is said of their order: they are numbered anew from the
 * root, level by level. */
sg_status flatten(const sg_cv_forest *f, size_t tree, std::vector<sg_cv_node> &to, sg_error *err)
{
    const std::vector<cv::ml::DTrees::Node> &nodes = f->trees->getNodes();
    const std::vector<cv::ml::DTrees::Split> &splits = f->trees->getSplits();
    std::vector<int> order(1, f->trees->getRoots().at(tree));
    for (size_t i = 0; i < order.size(); i++) {
        const cv::ml::DTrees::Node &from = nodes.at(static_cast<size_t>(order[i]));
        sg_cv_node node = {-1, 0, -1, -1, static_cast<int32_t>(std::lround(from.value))};
        if (from.split >= 0) {
            const cv::ml::DTrees::Split &split = splits.at(static_cast<size_t>(from.split));
            if (split.subsetOfs != 0 || split.inversed || from.left < 0 || from.right < 0)
                return SG_FAIL(err, SG_ENUMERIC, "OpenCV has made a split of an unknown kind");
            node.feature = split.varIdx;
            node.threshold = split.c;
            node.left = static_cast<int32_t>(order.size());
            node.right = node.left + 1;
            order.push_back(from.left);
            order.push_back(from.right);
        }
        to.push_back(node);
    }
    return SG_OK;
}

sg_status copy_tree(const sg_cv_forest *f, size_t tree, sg_cv_node **nodes, size_t *nnodes, sg_error *err)
{
    std::vector<sg_cv_node> flat;
    SG_TRY(flatten(f, tree, flat, err));
    sg_cv_node *copy = static_cast<sg_cv_node *>(std::malloc(flat.size() * sizeof flat[0]));
    if (copy == nullptr)
        return SG_FAIL_NOMEM(err);
    std::copy(flat.begin(), flat.end(), copy);
    *nodes = copy;
    *nnodes = flat.size();
    return SG_OK;
}

sg_status predict(const sg_cv_forest *f, const float *x, size_t n, uint8_t *classes)
{
    cv::Mat out;
    f->trees->predict(view(x, n, f->nfeatures), out);
    for (size_t i = 0; i < n; i++)
        classes[i] = static_cast<uint8_t>(out.at<float>(static_cast<int>(i)));
    return SG_OK;
}

/* OpenCV's table of votes begins with a row of class labels. */
sg_status votes_of(const sg_cv_forest *f, const float *x, size_t n, size_t nclasses, int32_t *votes, sg_error *err)
{
    cv::Mat table;
    f->trees->getVotes(view(x, n, f->nfeatures), table, 0);
    if (table.type() != CV_32S || static_cast<size_t>(table.rows) != n + 1)
        return SG_FAIL(err, SG_ENUMERIC, "OpenCV's table of votes has another form");
    std::fill(votes, votes + n * nclasses, 0);
    for (int c = 0; c < table.cols; c++) {
        const size_t label = static_cast<size_t>(table.at<int>(0, c));
        if (label >= nclasses)
            return SG_FAIL(err, SG_EINVAL, "class %zu of %zu", label, nclasses);
        for (size_t i = 0; i < n; i++)
            votes[i * nclasses + label] = table.at<int>(static_cast<int>(i) + 1, c);
    }
    return SG_OK;
}

} // namespace

sg_status sg_cv_samples_create(const float *x, size_t n, size_t nfeatures, const uint8_t *classes, sg_cv_samples **out,
                               sg_error *err)
{
    if (!fits(n, nfeatures))
        return SG_FAIL(err, SG_EINVAL, "%zu samples of %zu features", n, nfeatures);
    return sg_cv_guarded(err, SG_ENUMERIC, [&] { return take_samples(x, n, nfeatures, classes, out); });
}

void sg_cv_samples_free(sg_cv_samples *s)
{
    delete s;
}

sg_status sg_cv_forest_grow(const sg_cv_samples *s, const sg_cv_forest_opts *opts, uint64_t seed, sg_cv_forest **out,
                            sg_error *err)
{
    if (opts->trees == 0 || opts->trees > INT_MAX || opts->depth == 0 || opts->depth > SG_CV_MAX_DEPTH ||
        opts->min_leaf > INT_MAX || opts->active > s->nfeatures)
        return SG_FAIL(err, SG_EINVAL, "%zu trees of depth %zu with %zu of %zu features at a node", opts->trees,
                       opts->depth, opts->active, s->nfeatures);
    return sg_cv_guarded(err, SG_ENUMERIC, [&] { return grow(s, opts, seed, out, err); });
}

void sg_cv_forest_free(sg_cv_forest *f)
{
    delete f;
}

size_t sg_cv_forest_trees(const sg_cv_forest *f)
{
    return f->trees->getRoots().size();
}

size_t sg_cv_forest_features(const sg_cv_forest *f)
{
    return f->nfeatures;
}

sg_status sg_cv_forest_tree(const sg_cv_forest *f, size_t tree, sg_cv_node **nodes, size_t *nnodes, sg_error *err)
{
    if (tree >= sg_cv_forest_trees(f))
        return SG_FAIL(err, SG_EINVAL, "tree %zu of %zu", tree, sg_cv_forest_trees(f));
    return sg_cv_guarded(err, SG_ENUMERIC, [&] { return copy_tree(f, tree, nodes, nnodes, err); });
}

sg_status sg_cv_forest_predict(const sg_cv_forest *f, const float *x, size_t n, uint8_t *classes, sg_error *err)
{
    if (!fits(n, f->nfeatures))
        return SG_FAIL(err, SG_EINVAL, "%zu samples of %zu features", n, f->nfeatures);
    return sg_cv_guarded(err, SG_ENUMERIC, [&] { return predict(f, x, n, classes); });
}

sg_status sg_cv_forest_votes(const sg_cv_forest *f, const float *x, size_t n, size_t nclasses, int32_t *votes,
                             sg_error *err)
{
    if (!fits(n, f->nfeatures))
        return SG_FAIL(err, SG_EINVAL, "%zu samples of %zu features", n, f->nfeatures);
    return sg_cv_guarded(err, SG_ENUMERIC, [&] { return votes_of(f, x, n, nclasses, votes, err); });
}
