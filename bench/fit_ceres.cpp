#include "bench/fit_ceres.h"

#include <ceres/ceres.h>
#include <cstdio>
#include <deque>
#include <glog/logging.h>
#include <memory>
#include <vector>

#include "core/guard.hpp"

namespace
{

// Ceres tells a rank-deficient Jacobian on stderr as well as by its return value; a library does not print.
class Quiet
{
  public:
    Quiet() : level_(FLAGS_minloglevel)
    {
        FLAGS_minloglevel = google::GLOG_FATAL;
    }
    ~Quiet()
    {
        FLAGS_minloglevel = level_;
    }
    Quiet(const Quiet &) = delete;
    Quiet &operator=(const Quiet &) = delete;

  private:
    int level_;
};

// All rows are evaluated at once by the C callback; the cost functions below only hand them out.
class Evaluation : public ceres::EvaluationCallback
{
  public:
    explicit Evaluation(const dif_ls &ls)
        : ls_(ls), residual_(static_cast<size_t>(ls.n_row)),
          jacobian_(static_cast<size_t>(ls.n_row) * static_cast<size_t>(ls.stride))
    {
    }

    void PrepareForEvaluation(bool evaluate_jacobians, bool new_evaluation_point) override
    {
        if (!new_evaluation_point && (has_jacobian_ || !evaluate_jacobians))
            return;
        status_ = ls_.eval(ls_.self, ls_.par, residual_.data(), evaluate_jacobians ? jacobian_.data() : nullptr);
        has_jacobian_ = evaluate_jacobians;
    }

    dif_status status() const
    {
        return status_;
    }
    double residual(size_t row) const
    {
        return residual_[row];
    }
    const double *jacobian(size_t row) const
    {
        return jacobian_.data() + row * static_cast<size_t>(ls_.stride);
    }

  private:
    const dif_ls &ls_;
    std::vector<double> residual_, jacobian_;
    bool has_jacobian_ = false;
    dif_status status_ = DIF_OK;
};

class Row : public ceres::CostFunction
{
  public:
    Row(const Evaluation &evaluation, size_t row, int n_shared, int n_own)
        : evaluation_(evaluation), row_(row), n_shared_(n_shared), n_own_(n_own)
    {
        set_num_residuals(1);
        if (n_shared > 0)
            mutable_parameter_block_sizes()->push_back(n_shared);
        mutable_parameter_block_sizes()->push_back(n_own);
    }

    bool Evaluate(double const *const *, double *residuals, double **jacobians) const override
    {
        if (evaluation_.status() != DIF_OK)
            return false;
        residuals[0] = evaluation_.residual(row_);
        if (!jacobians)
            return true;
        const double *row = evaluation_.jacobian(row_);
        if (n_shared_ > 0 && jacobians[0]) // NULL where the shared parameters are held
            std::copy(row, row + n_shared_, jacobians[0]);
        double *own = jacobians[n_shared_ > 0 ? 1 : 0];
        if (own)
            std::copy(row + n_shared_, row + n_shared_ + n_own_, own);
        return true;
    }

  private:
    const Evaluation &evaluation_;
    size_t row_;
    int n_shared_, n_own_;
};

// Start of each block in the parameter vector.
std::vector<double *> block_starts(const dif_ls &ls)
{
    std::vector<double *> start;
    double *p = ls.par + ls.n_shared;
    for (int b = 0; b < ls.n_block; b++) {
        start.push_back(p);
        p += ls.size[b];
    }
    return start;
}

void add_bounds(const dif_ls &ls, ceres::Problem *problem)
{
    for (int i = 0; i < ls.n_shared; i++) {
        if (ls.low)
            problem->SetParameterLowerBound(ls.par, i, ls.low[i]);
        if (ls.high)
            problem->SetParameterUpperBound(ls.par, i, ls.high[i]);
    }
}

// The blocks are eliminated first, the shared parameters remain: variable projection's linear algebra.
ceres::Solver::Options solver_options(const dif_ls &ls, const std::vector<double *> &block)
{
    // one or two blocks: forming the whole normal matrix at once is faster than eliminating row by row
    const bool schur = ls.n_shared > 0 && !ls.hold_shared && ls.n_block > 2;
    ceres::Solver::Options options;
    options.logging_type = ceres::SILENT;
    options.minimizer_progress_to_stdout = false;
    options.linear_solver_type = schur ? ceres::DENSE_SCHUR : ceres::DENSE_NORMAL_CHOLESKY;
    options.max_num_iterations = ls.n_iteration_max;
    if (ls.linear)
        options.initial_trust_region_radius = 1e12;
    options.function_tolerance = 1e-11;
    options.parameter_tolerance = 1e-11;
    options.gradient_tolerance = 1e-16;
    if (!schur)
        return options;
    options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    for (double *p : block)
        options.linear_solver_ordering->AddElementToGroup(p, 0);
    options.linear_solver_ordering->AddElementToGroup(ls.par, 1);
    return options;
}

// False if the Jacobian has no full rank.
bool shared_covariance(const dif_ls &ls, ceres::Problem *problem, double *out)
{
    ceres::Covariance::Options options;
    options.algorithm_type = ceres::SPARSE_QR;
    options.apply_loss_function = true;
    ceres::Covariance covariance(options);
    const std::vector<std::pair<const double *, const double *>> pairs{{ls.par, ls.par}};
    return covariance.Compute(pairs, problem) && covariance.GetCovarianceBlock(ls.par, ls.par, out);
}

} // namespace

dif_status dif_ls_solve(const dif_ls *ls, double *covariance, dif_ls_report *report, dif_error *err)
{
    *report = dif_ls_report{};
    return dif_guard(err, [&] {
        const Quiet quiet;
        Evaluation evaluation(*ls);
        const std::unique_ptr<ceres::LossFunction> loss(ls->loss_scale > 0.0 ? new ceres::HuberLoss(ls->loss_scale)
                                                                             : nullptr);
        std::deque<Row> rows; // a Row cannot be moved
        ceres::Problem::Options problem_options;
        problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
        problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
        problem_options.evaluation_callback = &evaluation;
        ceres::Problem problem(problem_options);
        const std::vector<double *> block = block_starts(*ls);
        for (int i = 0; i < ls->n_row; i++) {
            const int b = ls->row_block[i];
            rows.emplace_back(evaluation, static_cast<size_t>(i), ls->n_shared, ls->size[b]);
            double *own = block[static_cast<size_t>(b)];
            if (ls->n_shared > 0)
                problem.AddResidualBlock(&rows.back(), loss.get(), ls->par, own);
            else
                problem.AddResidualBlock(&rows.back(), loss.get(), own);
        }
        if (ls->hold_shared && ls->n_shared > 0)
            problem.SetParameterBlockConstant(ls->par);
        else
            add_bounds(*ls, &problem);
        ceres::Solver::Summary summary;
        ceres::Solve(solver_options(*ls, block), &problem, &summary);
        if (evaluation.status() != DIF_OK)
            return dif_fail(err, evaluation.status(), "the model could not be evaluated");
        report->converged = summary.termination_type == ceres::CONVERGENCE;
        report->n_iteration = static_cast<int>(summary.iterations.size());
        report->cost = summary.final_cost;
        std::snprintf(report->text, sizeof report->text, "%s", summary.message.c_str());
        if (summary.IsSolutionUsable() && ls->want_covariance && covariance)
            report->has_covariance = shared_covariance(*ls, &problem, covariance);
        return DIF_OK;
    });
}
