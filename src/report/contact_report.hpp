// What a report says of contact: a page, a table and plots.
#pragma once

#include <string>
#include <vector>

#include "contact_cases.hpp"

namespace corotet::program {

struct ContactCaseReport {
  ContactCase of;
  std::vector<ContactRow> rows;
};

/// One line a quantity of each run.
[[nodiscard]] std::string format_contact_csv(const std::vector<ContactCaseReport>& reports);

/// `command`: that printed it.
[[nodiscard]] std::string format_contact_markdown(const std::vector<ContactCaseReport>& reports,
                                                  const std::string& command);

/// Error of the first quantity against the time for 1/60 s of motion, as SVG; empty if no run has both.
[[nodiscard]] std::string plot_contact(const ContactCaseReport& report);
/// The name of its file.
[[nodiscard]] std::string plot_name(const ContactCaseReport& report);

}  // namespace corotet::program
