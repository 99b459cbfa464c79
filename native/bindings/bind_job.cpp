#include "convert/convert.h"

namespace saddleback::bindings {

void bind_job(py::module_& m) {
  py::class_<Job>(m, "Job", py::module_local(),
                  R"(A token for long work: one thread computes with it, another watches or stops it.

Pass it as ``job=`` and read ``fraction`` and ``text`` from any other thread meanwhile. A job may be used again; its
fraction then starts from 0. Once cancelled it stays cancelled.)")
      .def(py::init([] { return std::make_unique<Job>(); }))
      .def_property_readonly("fraction", &Job::fraction,
                             "Share of the work done, 0 to 1, never falling during one call.")
      .def_property_readonly("text", &Job::text, "The work being done, for a person to read.")
      .def_property_readonly("cancelled", &Job::cancelled, "True once `cancel` was called.")
      .def(
          "part",
          [](const Job& job, const py::object& begin, const py::object& end) {
            return job.part(as_real(begin, "begin"), as_real(end, "end"));
          },
          py::arg("begin"), py::arg("end"),
          R"(A job for a part of this one's work, from `begin` to `end` in its 0 to 1.

Several calls, each with the part that comes after the last one's, report one rising fraction; what is done to a part is
done to the whole. Raises InputError unless 0 <= begin <= end <= 1.)")
      .def(
          "update", [](const Job& job, const py::object& fraction) { job.update(as_real(fraction, "fraction")); },
          py::arg("fraction"),
          "Say how far the work between calls has come, 0 to 1; raises `Cancelled` when asked to stop.")
      .def("cancel", &Job::cancel, "Ask the work to stop: within 0.1 s its call raises `Cancelled`.")
      .def("__repr__", [](const Job& job) {
        return message("<saddleback.Job ", static_cast<int>(100 * job.fraction()), " %",
                       job.cancelled() ? ", cancelled" : "", ">");
      });
}

}  // namespace saddleback::bindings
