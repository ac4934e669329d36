#include "calibration/core/lens/lens_model.h"

namespace vismem {

std::string nameOf(LensModel model) {
  switch (model) {
    case LensModel::kPinhole:
      return "f";
    case LensModel::kRadial:
      return "f k1 k2";
    case LensModel::kTangential:
      return "f k1 k2 p1 p2";
    case LensModel::kFull:
      break;
  }
  return "f k1 k2 p1 p2 k3";
}

int freeParameters(LensModel model) {
  switch (model) {
    case LensModel::kPinhole:
      return 4;
    case LensModel::kRadial:
      return 6;
    case LensModel::kTangential:
      return 8;
    case LensModel::kFull:
      break;
  }
  return kLensParameters;
}

LensVector lensVector(const CameraIntrinsics& k) {
  LensVector vector;
  vector << k.fx, k.fy, k.cx, k.cy, k.k1, k.k2, k.p1, k.p2, k.k3;
  return vector;
}

CameraIntrinsics lensFrom(const LensVector& v, int width, int height) {
  return {width, height, v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7], v[8]};
}

}  // namespace vismem
