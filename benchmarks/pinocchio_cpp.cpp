// Pinocchio's algorithms in loops over rows, called from Python: see pinocchio_cpp.py.
//
// Every function takes the number of rows, the inputs, and where the results go; where that is null they stay in
// Pinocchio's Data, as a program that uses it would leave them.

#include <pinocchio/algorithm/aba-derivatives.hpp>
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/regressor.hpp>
#include <pinocchio/algorithm/rnea-derivatives.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/multibody.hpp>
#include <string>

using namespace pinocchio;
using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Row = Eigen::Map<const Vector>;
using Turn = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using Place = Eigen::Map<const Eigen::Vector3d>;

struct Robot {
  Model model;
  Data data;
  FrameIndex flange;
  Matrix d_q, d_v, d_a, J;
  Vector q, v, a, before, now, after, outer_before, outer_after;
};

static SE3 pose(const double *x) { return SE3(Eigen::Map<const Turn>(x), Place(x + 9)); }

static Row row(const Robot &r, const double *x, long k) { return Row(x + k * r.model.nv, r.model.nv); }

static void keep(double *out, long k, const Eigen::Ref<const Matrix> &found) {
  if (out) Eigen::Map<Rows>(out + k * found.size(), found.rows(), found.cols()) = found;
}

extern "C" {

// a joint's numbers: parent, pose (12), axis (3), mass, com (3), inertia about it (9); then the flange's pose (12)
Robot *robot(int n, const double *x, const double *gravity) {
  auto *r = new Robot;
  r->model.gravity.linear() = Place(gravity);
  for (int i = 0; i < n; i++, x += 29) {
    const JointIndex parent = (JointIndex)x[0] + 1;
    const SE3 placement = pose(x + 1);
    const std::string name = "joint" + std::to_string(i);
    JointIndex joint;
    if (x[13] == 1) joint = r->model.addJoint(parent, JointModelRX(), placement, name);
    else if (x[14] == 1) joint = r->model.addJoint(parent, JointModelRY(), placement, name);
    else if (x[15] == 1) joint = r->model.addJoint(parent, JointModelRZ(), placement, name);
    else joint = r->model.addJoint(parent, JointModelRevoluteUnaligned(x[13], x[14], x[15]), placement, name);
    const Inertia body(x[16], Place(x + 17), Eigen::Matrix3d(Eigen::Map<const Turn>(x + 20)));
    r->model.appendBodyToJoint(joint, body, SE3::Identity());
  }
  const JointIndex last = r->model.njoints - 1;
  r->flange = r->model.addFrame(Frame("flange", last, 0, pose(x), OP_FRAME));
  r->data = Data(r->model);
  r->d_q = r->d_v = r->d_a = Matrix::Zero(n, n);
  r->J = Matrix::Zero(6, n);
  r->q = r->v = r->a = Vector::Zero(n);
  return r;
}

void forget(Robot *r) { delete r; }

void inverse_dynamics(Robot *r, long count, const double *q, const double *v, const double *a, double *out) {
  for (long k = 0; k < count; k++) keep(out, k, rnea(r->model, r->data, row(*r, q, k), row(*r, v, k), row(*r, a, k)));
}

void forward_dynamics(Robot *r, long count, const double *q, const double *v, const double *tau, double *out) {
  for (long k = 0; k < count; k++)
    keep(out, k, aba(r->model, r->data, row(*r, q, k), row(*r, v, k), row(*r, tau, k), Convention::WORLD));
}

void forward_dynamics_local(Robot *r, long count, const double *q, const double *v, const double *tau, double *out) {
  for (long k = 0; k < count; k++)
    keep(out, k, aba(r->model, r->data, row(*r, q, k), row(*r, v, k), row(*r, tau, k), Convention::LOCAL));
}

static void mirrored(Robot *r, double *out, long k) {
  if (out) r->data.M.triangularView<Eigen::StrictlyLower>() = r->data.M.transpose();
  keep(out, k, r->data.M);
}

void mass_matrix(Robot *r, long count, const double *q, double *out) {
  for (long k = 0; k < count; k++) {
    crba(r->model, r->data, row(*r, q, k), Convention::WORLD);
    mirrored(r, out, k);
  }
}

void mass_matrix_local(Robot *r, long count, const double *q, double *out) {
  for (long k = 0; k < count; k++) {
    crba(r->model, r->data, row(*r, q, k), Convention::LOCAL);
    mirrored(r, out, k);
  }
}

void jacobian(Robot *r, long count, const double *q, double *out) {
  for (long k = 0; k < count; k++) {
    computeFrameJacobian(r->model, r->data, row(*r, q, k), r->flange, LOCAL_WORLD_ALIGNED, r->J);
    keep(out, k, r->J);
  }
}

void derivatives(Robot *r, long count, const double *q, const double *v, const double *a, double *out) {
  for (long k = 0; k < count; k++) {
    computeRNEADerivatives(r->model, r->data, row(*r, q, k), row(*r, v, k), row(*r, a, k), r->d_q, r->d_v, r->d_a);
    if (!out) continue;
    r->d_a.triangularView<Eigen::StrictlyLower>() = r->d_a.transpose();
    keep(out, 3 * k, r->d_q);
    keep(out, 3 * k + 1, r->d_v);
    keep(out, 3 * k + 2, r->d_a);
  }
}

void forward_derivatives(Robot *r, long count, const double *q, const double *v, const double *tau, double *out) {
  for (long k = 0; k < count; k++) {
    computeABADerivatives(r->model, r->data, row(*r, q, k), row(*r, v, k), row(*r, tau, k));
    if (!out) continue;
    r->data.Minv.triangularView<Eigen::StrictlyLower>() = r->data.Minv.transpose();
    keep(out, 3 * k, r->data.ddq_dq);
    keep(out, 3 * k + 1, r->data.ddq_dv);
    keep(out, 3 * k + 2, r->data.Minv);
  }
}

void regressor(Robot *r, long count, const double *q, const double *v, const double *a, double *out) {
  for (long k = 0; k < count; k++) {
    computeJointTorqueRegressor(r->model, r->data, row(*r, q, k), row(*r, v, k), row(*r, a, k));
    keep(out, k, r->data.jointTorqueRegressor);
  }
}

// torque at a time h from now on a motion of constant snap
static const Vector &torque_at(Robot *r, const Row *x, double h) {
  r->q = x[0] + h * (x[1] + h / 2 * (x[2] + h / 3 * (x[3] + h / 4 * x[4])));
  r->v = x[1] + h * (x[2] + h / 2 * (x[3] + h / 3 * x[4]));
  r->a = x[2] + h * (x[3] + h / 2 * x[4]);
  return rnea(r->model, r->data, r->q, r->v, r->a);
}

// motor torques of joints with stiffness and reflected inertia given, torque'' from 3 or 5 inverse dynamics h apart
void elastic(Robot *r, long count, const double *q, const double *v, const double *a, const double *jerk,
             const double *snap, double *out, int points, double h, double stiffness, double inertia) {
  for (long k = 0; k < count; k++) {
    const Row x[] = {row(*r, q, k), row(*r, v, k), row(*r, a, k), row(*r, jerk, k), row(*r, snap, k)};
    r->now = torque_at(r, x, 0);
    r->before = torque_at(r, x, -h);
    r->after = torque_at(r, x, h);
    r->before += r->after;
    if (points == 5) {
      r->outer_before = torque_at(r, x, -2 * h);
      r->outer_after = torque_at(r, x, 2 * h);
      r->before = (16 * r->before - r->outer_before - r->outer_after - 30 * r->now) / (12 * h * h);
    } else {
      r->before = (r->before - 2 * r->now) / (h * h);
    }
    r->after = inertia * (x[2] + r->before / stiffness) + r->now;
    keep(out, k, r->after);
  }
}
}
