// Orocos KDL's solvers in loops over rows, called from Python: see kdl_peer.py.
//
// Every function takes the number of rows, the inputs, and where the results go; where that is null they stay in KDL's
// arrays, as a program that uses it would leave them.

#include <kdl/chaindynparam.hpp>
#include <kdl/chainfdsolver_recursive_newton_euler.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <kdl/chainjnttojacsolver.hpp>

using namespace KDL;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

struct Robot {
  Chain chain;
  ChainIdSolver_RNE inverse;
  ChainFdSolver_RNE forward;
  ChainDynParam parameters;
  ChainJntToJacSolver kinematics;
  JntArray q, v, third, found;
  JntSpaceInertiaMatrix M;
  Jacobian J;
  Wrenches none;

  Robot(const Chain &given, unsigned n, const Vector &gravity)
      : chain(given), inverse(chain, gravity), forward(chain, gravity), parameters(chain, gravity), kinematics(chain),
        q(n), v(n), third(n), found(n), M(n), J(n), none(chain.getNrOfSegments(), Wrench::Zero()) {}
};

static Vector vector(const double *x) { return Vector(x[0], x[1], x[2]); }

static Frame pose(const double *x) {
  return Frame(Rotation(x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7], x[8]), vector(x + 9));
}

static void read(JntArray &to, const double *x, long k) {
  to.data = Eigen::Map<const Eigen::VectorXd>(x + k * to.data.size(), to.data.size());
}

template <class Found> static void keep(double *out, long k, const Found &found) {
  if (out) Eigen::Map<Rows>(out + k * found.size(), found.rows(), found.cols()) = found;
}

extern "C" {

// a joint's numbers: parent, pose (12), axis (3), mass, com (3), inertia about it (9); then the flange's pose (12)
Robot *robot(int n, const double *x, const double *gravity) {
  Chain chain;
  for (int i = 0; i < n; i++, x += 29) {
    const Frame placement = pose(x + 1);
    const Joint joint(placement.p, placement.M * vector(x + 13), Joint::RotAxis);
    const RotationalInertia inertia(x[20], x[24], x[28], x[21], x[22], x[25]);
    chain.addSegment(Segment(joint, placement, RigidBodyInertia(x[16], vector(x + 17), inertia)));
  }
  chain.addSegment(Segment(Joint(Joint::None), pose(x)));
  return new Robot(chain, n, vector(gravity));
}

void forget(Robot *r) { delete r; }

void inverse_dynamics(Robot *r, long count, const double *q, const double *v, const double *a, double *out) {
  for (long k = 0; k < count; k++) {
    read(r->q, q, k), read(r->v, v, k), read(r->third, a, k);
    r->inverse.CartToJnt(r->q, r->v, r->third, r->none, r->found);
    keep(out, k, r->found.data);
  }
}

void forward_dynamics(Robot *r, long count, const double *q, const double *v, const double *tau, double *out) {
  for (long k = 0; k < count; k++) {
    read(r->q, q, k), read(r->v, v, k), read(r->third, tau, k);
    r->forward.CartToJnt(r->q, r->v, r->third, r->none, r->found);
    keep(out, k, r->found.data);
  }
}

void mass_matrix(Robot *r, long count, const double *q, double *out) {
  for (long k = 0; k < count; k++) {
    read(r->q, q, k);
    r->parameters.JntToMass(r->q, r->M);
    keep(out, k, r->M.data);
  }
}

void jacobian(Robot *r, long count, const double *q, double *out) {
  for (long k = 0; k < count; k++) {
    read(r->q, q, k);
    r->kinematics.JntToJac(r->q, r->J);
    keep(out, k, r->J.data);
  }
}
}
