// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cerberus/truth.h>

#include <algorithm>

#include "cerberus/private/define.hpp"

namespace {

CerberusTruth sane(CerberusTruth truth) {
  truth.n_persons = std::min<guint>(truth.n_persons, CERBERUS_TRUTH_MAX_PERSONS);
  return truth;
}

gboolean transform_meta(GstBuffer* to, GstMeta* meta, GstBuffer* from, GQuark type, gpointer data);

}  // namespace

template <typename Archive>
static void exchange(Archive& archive, CerberusTruth& truth) {
  archive(truth.n_persons, truth.base_x, truth.base_y, truth.base_heading, truth.base_speed,
          truth.base_yaw_rate, truth.pan, truth.tilt);
  truth = sane(truth);
  for (guint i = 0; i < truth.n_persons; ++i) {
    CerberusTruthPerson& p = truth.persons[i];
    archive(p.id, p.x, p.y, p.width, p.height, p.visible, p.bearing, p.distance, p.speed);
  }
}

CERBERUS_DEFINE_BOXED(CerberusTruthPerson, cerberus_truth_person, cerberus::zero)
CERBERUS_DEFINE_BOXED(CerberusTruth, cerberus_truth, cerberus::zero)
CERBERUS_DEFINE_META(CerberusTruth, truth, sane, transform_meta, GST_META_TAG_VIDEO_STR,
                     GST_META_TAG_VIDEO_SIZE_STR)

namespace {

gboolean transform_meta(GstBuffer* to, GstMeta*, GstBuffer* from, GQuark type, gpointer data) {
  const auto sizes = cerberus::rescaling(type, data);
  const CerberusTruth* carried = CerberusTruthCarried::peek(from);
  if (!sizes || !carried) return FALSE;
  CerberusTruth truth = *carried;
  const double wider = double(sizes->to.width) / sizes->from.width,
               higher = double(sizes->to.height) / sizes->from.height;
  for (guint i = 0; i < truth.n_persons; ++i) {
    CerberusTruthPerson& person = truth.persons[i];
    person.x *= wider, person.width *= wider;
    person.y *= higher, person.height *= higher;
  }
  return CerberusTruthCarried::set(to, &truth);
}

}  // namespace

CerberusTruthPerson* cerberus_truth_get_person(const CerberusTruth* truth, guint index) {
  g_return_val_if_fail(truth, nullptr);
  return index < truth->n_persons ? cerberus_truth_person_copy(&truth->persons[index]) : nullptr;
}
