// Fits the equations of several joints by robust least squares with priors. The intervals account
// for the correlation of neighbouring windows.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace predictor {

// The equations of one joint. Column i belongs to parameter index[i] of the whole problem.
struct FitRows {
  std::vector<long> window;  // window of each row
  Eigen::VectorXd y;
  Eigen::MatrixXd x;
  std::vector<int> index;  // column -> parameter
};

struct FitProblem {
  std::vector<FitRows> joints;
  int parameters = 0;
};

// Renumbers the windows in ascending order and shortens gaps to the length of the windows'
// correlation. The fit needs memory for all windows from the first to the last, and a recording may
// number its windows arbitrarily.
void CloseGaps(FitProblem* problem);

// The free parameters and their prior, which has the mean 0 and the given precision (1/variance). A
// precision of 0 means that there is no prior. All other parameters are 0.
struct FitModel {
  std::vector<int> free;      // parameters, ascending
  Eigen::VectorXd precision;  // of all parameters
};

struct Fit {
  Eigen::VectorXd value;       // of all parameters
  Eigen::MatrixXd covariance;  // of the requested parameters
  double quantile = 1.96;      // half-width of a 95 % interval divided by the standard error
  std::vector<double> scale;   // robust standard deviation of a joint's residuals
  std::vector<double> excess;  // variance of a mean of the residuals relative to independent
                               // residuals, at least 1
  std::vector<Eigen::VectorXd> residual;  // residuals of each joint's rows
  std::vector<Eigen::VectorXd> weight;    // Huber's weights, divided by scale² excess
};

// Computes Huber's M-estimate by iterative reweighting. The covariance of `wanted` is a sandwich
// estimate: the long-run covariance of the scores (Newey & West 1987, with the lag of Andrews 1991
// for an AR(1) process) between two inverse curvatures, times N/(N − p) for the p estimated
// parameters. The contribution of the prior is added.
Fit FitRobustly(const FitProblem& problem, const FitModel& model, const std::vector<int>& wanted);

// Leaves out each block of time in turn and predicts this block from the other blocks (with the
// weights of the fit).
struct CrossValidation {
  std::vector<double> loss;           // mean of Huber's loss in each block, in units of scale
  std::vector<double> error_squares;  // sum for each joint [N²·m²]
  std::vector<double> rows;           // one per joint
};
CrossValidation CrossValidate(const FitProblem& problem, const FitModel& model, const Fit& fit,
                              const std::vector<double>& scale, int blocks);

// Returns those parameters in `among` that the (weighted) equations can distinguish, ordered by the
// information that each parameter adds to the previous parameters. `condition` is the condition
// number of the columns of these parameters and of `always`, scaled to unit length.
std::vector<int> BaseParameters(const FitProblem& problem, const Fit& fit,
                                const std::vector<int>& always, const std::vector<int>& among,
                                double* condition);

}  // namespace predictor
