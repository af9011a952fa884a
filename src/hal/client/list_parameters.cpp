#include "hal/client/list_parameters.hpp"

#include <sstream>

namespace kerf::hal {

std::optional<std::vector<std::string>> list_parameters(Session& session,
                                                        const std::string& component) {
  const std::vector<std::string> words{"list-parameters", component};
  const auto reply = session.request(words);
  if (!reply.ok() || !reply->ok()) return std::nullopt;
  std::vector<std::string> names;
  std::istringstream text(reply->text);
  for (std::string name; text >> name;) names.push_back(name);
  return names;
}

}  // namespace kerf::hal
