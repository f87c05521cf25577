// Robust least squares with priors over the equations of several joints, with intervals that count
// what neighbouring windows have in common.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace predictor {

// The equations of one joint, with columns that stand for parameters `index` of the whole.
struct FitRows {
  std::vector<long> window;  // of each row
  Eigen::VectorXd y;
  Eigen::MatrixXd x;
  std::vector<int> index;  // column -> parameter
};

struct FitProblem {
  std::vector<FitRows> joints;
  int parameters = 0;
};

// Numbers the windows anew, ascending as they are, with gaps no longer than what windows have in
// common reaches: the fit needs memory from the first to the last, and a recording may claim any.
void CloseGaps(FitProblem* problem);

// A choice of the parameters that are free, and what is believed of them: value 0, with a
// precision (1/variance); 0: nothing. The others are 0.
struct FitModel {
  std::vector<int> free;      // parameters, ascending
  Eigen::VectorXd precision;  // of all parameters
};

struct Fit {
  Eigen::VectorXd value;                  // of all parameters
  Eigen::MatrixXd covariance;             // of the parameters asked for
  double quantile = 1.96;                 // half-width of a 95 % interval over the standard error
  std::vector<double> scale;              // robust standard deviation of a joint's residuals
  std::vector<double> excess;             // by which a mean of them is less certain than if they
                                          // were independent (variance ratio), at least 1
  std::vector<Eigen::VectorXd> residual;  // of each joint's rows
  std::vector<Eigen::VectorXd> weight;    // Huber's, over scale² excess
};

// Huber's M-estimate, iteratively reweighted. The covariance of `wanted` is a sandwich: the scores'
// long-run covariance (Newey & West 1987, lag by Andrews 1991 with an AR(1)) between the
// curvatures, times N/(N − p) for the parameters spent, and the prior's share.
Fit FitRobustly(const FitProblem& problem, const FitModel& model, const std::vector<int>& wanted);

// Blocks of time left out in turn, each foretold by the others (with the fit's weights).
struct CrossValidation {
  std::vector<double> loss;           // of each block: mean of Huber's loss, in units of scale
  std::vector<double> error_squares;  // of each joint, summed [N²·m²]
  std::vector<double> rows;           // of each joint
};
CrossValidation CrossValidate(const FitProblem& problem, const FitModel& model, const Fit& fit,
                              const std::vector<double>& scale, int blocks);

// Of the parameters in `among`, in the order of how much they tell beyond those before: as many as
// the (weighted) equations tell apart. `condition`: of these and `always`, columns of unit length.
std::vector<int> BaseParameters(const FitProblem& problem, const Fit& fit,
                                const std::vector<int>& always, const std::vector<int>& among,
                                double* condition);

}  // namespace predictor
