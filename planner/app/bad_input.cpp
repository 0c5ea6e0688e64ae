#include "bad_input.hpp"

#include <new>

namespace frontlux::app {

void work_on(const std::string& input, const char* memory, const std::function<void()>& work) {
  try {
    work();
  } catch (const BadInput&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw BadInput(input + ": there is not enough memory; " + memory);
  } catch (const std::invalid_argument& error) {
    throw BadInput(input + ": " + error.what());
  } catch (const std::runtime_error& error) {
    throw BadInput(error.what());
  }
}

}  // namespace frontlux::app
